#include "engine/optics/named_materials.h"

#include <algorithm>
#include <array>

namespace quadgraph {
namespace {

constexpr std::string_view measured = "measured: Jensen et al. 2001, Figure 5";
constexpr std::string_view made_up = "made up: chosen by eye, to look like what the name says";

constexpr std::array<NamedMaterial, 31> all = {{
    {"apple", "sigma_s_prime=2.29/2.39/1.97,sigma_a=0.0030/0.0034/0.046,eta=1.3", measured},
    {"chicken1", "sigma_s_prime=0.15/0.21/0.38,sigma_a=0.015/0.077/0.19,eta=1.3", measured},
    {"chicken2", "sigma_s_prime=0.19/0.25/0.32,sigma_a=0.018/0.088/0.20,eta=1.3", measured},
    {"cream", "sigma_s_prime=7.38/5.47/3.15,sigma_a=0.0002/0.0028/0.0163,eta=1.3", measured},
    {"ketchup", "sigma_s_prime=0.18/0.07/0.03,sigma_a=0.061/0.97/1.45,eta=1.3", measured},
    {"marble", "sigma_s_prime=2.19/2.62/3.00,sigma_a=0.0021/0.0041/0.0071,eta=1.5", measured},
    {"potato", "sigma_s_prime=0.68/0.70/0.55,sigma_a=0.0024/0.0090/0.12,eta=1.3", measured},
    {"skimmilk", "sigma_s_prime=0.70/1.22/1.90,sigma_a=0.0014/0.0025/0.0142,eta=1.3", measured},
    {"skin1", "sigma_s_prime=0.74/0.88/1.01,sigma_a=0.032/0.17/0.48,eta=1.3", measured},
    {"skin2", "sigma_s_prime=1.09/1.59/1.79,sigma_a=0.013/0.070/0.145,eta=1.3", measured},
    {"spectralon", "sigma_s_prime=11.6/20.4/14.9,sigma_a=0,eta=1.3", measured},
    {"wholemilk", "sigma_s_prime=2.55/3.21/3.77,sigma_a=0.0011/0.0024/0.014,eta=1.3", measured},
    {"marble-veins",
     "marble,pattern=veins,second_sigma_s_prime=1.2,second_sigma_a=0.85/0.78/0.74,period=16,sharpness=14", made_up},
    {"jade",
     "reflectance=0.30/0.62/0.42,mean_free_path=0.8,eta=1.6,pattern=clouds,second_reflectance=0.04/0.22/0.11,"
     "second_mean_free_path=0.6,period=14,sharpness=4",
     made_up},
    {"agate",
     "reflectance=0.90/0.84/0.74,mean_free_path=0.9,eta=1.54,pattern=bands,second_reflectance=0.38/0.09/0.04,"
     "second_mean_free_path=0.5,period=5,sharpness=4",
     made_up},
    {"wax",
     "reflectance=0.86/0.80/0.66,mean_free_path=0.7,eta=1.44,pattern=spots,second_reflectance=0.10/0.32/0.48,"
     "second_mean_free_path=0.5,period=7,sharpness=5",
     made_up},
    {"wood",
     "reflectance=0.66/0.45/0.25,mean_free_path=0.3,eta=1.5,pattern=rings,second_reflectance=0.32/0.16/0.07,"
     "second_mean_free_path=0.25,period=5,sharpness=2",
     made_up},
    {"checker",
     "reflectance=0.8,mean_free_path=0.5,eta=1.3,pattern=checker,second_reflectance=0.15/0.2/0.4,"
     "second_mean_free_path=0.5,period=12,sharpness=1",
     made_up},
    {"layered-skin",
     "sigma_s_prime=1.1/1.5/1.9,sigma_a=0.05/0.22/0.5,eta=1.4,pattern=layers,second_sigma_s_prime=1.3/1.2/1.1,"
     "second_sigma_a=0.004/0.012/0.02,period=1.5,sharpness=3",
     made_up},
    {"milk", "wholemilk,roughness=0.1", "as wholemilk, which is measured: Jensen et al. 2001, Figure 5"},
    {"candle", "sigma_s_prime=1/0.95/0.9,sigma_a=0.0005/0.003/0.012,eta=1.44,roughness=0.35", made_up},
    {"soap", "sigma_s_prime=1.2/1.3/1.4,sigma_a=0.001/0.002/0.006,eta=1.46,roughness=0.5", made_up},
    {"porcelain", "sigma_s_prime=4.2/4.4/4.7,sigma_a=0.0012/0.0018/0.0035,eta=1.5,roughness=0.06", made_up},
    {"alabaster",
     "sigma_s_prime=1.3/1.4/1.5,sigma_a=0.0005/0.0014/0.004,eta=1.52,pattern=veins,second_sigma_s_prime=1.6,"
     "second_sigma_a=0.03/0.07/0.14,period=26,sharpness=7,roughness=0.3",
     made_up},
    {"honey", "sigma_s_prime=0.03,sigma_a=0.003/0.025/0.25,eta=1.49,roughness=0.05", made_up},
    {"gummy", "sigma_s_prime=0.09,sigma_a=0.005/0.17/0.2,eta=1.45,roughness=0.15", made_up},
    {"silicone", "sigma_s_prime=0.3/0.33/0.36,sigma_a=0.0004/0.0005/0.0007,eta=1.41,roughness=0.4", made_up},
    {"resin", "sigma_s_prime=0.05,sigma_a=0.002/0.007/0.035,eta=1.55,roughness=0.08", made_up},
    {"leaf", "sigma_s_prime=1.6,sigma_a=0.36/0.09/0.8,eta=1.42,roughness=0.35", made_up},
    {"cheese", "reflectance=0.9/0.71/0.33,mean_free_path=0.7,eta=1.4,roughness=0.5", made_up},
    {"dark-skin", "reflectance=0.171/0.084/0.058,mean_free_path=1.2/1/0.8,eta=1.4,roughness=0.35",
     "made up: the colour of the ColorChecker's patch 'dark skin', its depth chosen by eye"},
}};

}  // namespace

std::span<const NamedMaterial> named_materials() {
  return all;
}

const NamedMaterial* named_material(std::string_view name) {
  const auto row = std::find_if(all.begin(), all.end(), [&](const NamedMaterial& each) { return each.name == name; });
  return row != all.end() ? &*row : nullptr;
}

}  // namespace quadgraph
