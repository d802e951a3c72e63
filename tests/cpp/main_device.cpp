// The main of tests that open devices. A test case that leaves a device behind, or anything of one, fails the run.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdint>
#include <iostream>

#include "engine/device/live_objects.h"

namespace {

int leaking_test_cases = 0;

class LeakListener : public doctest::IReporter {
 public:
  explicit LeakListener(const doctest::ContextOptions&) {}

  void test_case_start(const doctest::TestCaseData& test) override {
    test_ = &test;
    first_device_ = quadgraph::device::devices_opened();
  }

  void test_case_end(const doctest::CurrentTestCaseStats&) override {
    const quadgraph::device::LiveObjects left = quadgraph::device::live_objects(first_device_);
    if (left.empty()) return;
    ++leaking_test_cases;
    std::cerr << test_->m_file.c_str() << ":" << test_->m_line << ": '" << test_->m_name << "' left behind:";
    for (const auto& [kind, number] : left) std::cerr << " " << number << " " << kind;
    std::cerr << std::endl;
  }

  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats&) override {}
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_exception(const doctest::TestCaseException&) override {}
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData&) override {}
  void log_message(const doctest::MessageData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}

 private:
  const doctest::TestCaseData* test_ = nullptr;
  std::uint64_t first_device_ = 0;
};

REGISTER_LISTENER("leaks", 1, LeakListener);

}  // namespace

int main(int argc, char** argv) {
  const int result = doctest::Context(argc, argv).run();
  return result != 0 ? result : leaking_test_cases;
}
