"""The chart's page in headless Chromium: it draws, hover tells a point, the legend filters, nothing complains."""

from __future__ import annotations

import time

import pytest

from chart_records import FAMILIES, record
from quadgraph_validation.chart import chart_page

POINTS = ".scatterlayer .points path.point"


@pytest.fixture
def opened(browser, tmp_path):
    path = chart_page.write(tmp_path / "chart.html", record())
    browser.set_window_size(1300, 1200)
    browser.get(path.as_uri())
    wait_for(lambda: len(elements(browser, f"#chart-sphere {POINTS}")) == 4 * 13)
    yield browser
    assert browser.get_log("browser") == []


def elements(browser, selector):
    return browser.find_elements("css selector", selector)


def wait_for(condition, seconds=120.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "the page did not get there"
        time.sleep(0.1)


def test_hover_tells_a_point_its_time_and_its_errors(opened):
    from selenium.webdriver.common.action_chains import ActionChains

    ActionChains(opened).move_to_element(elements(opened, f"#chart-bunny {POINTS}")[0]).perform()
    wait_for(lambda: elements(opened, "#chart-bunny .hoverlayer .hovertext"))
    text = elements(opened, "#chart-bunny .hoverlayer .hovertext")[0].text
    assert FAMILIES[0] in text
    assert "ms (" in text
    assert "PDE truth: whole" in text
    assert "path tracing: whole" in text


def test_the_legend_hides_a_family_and_shows_it_again(opened):
    shown = len(elements(opened, f"#chart-bunny {POINTS}"))
    names = [entry.text for entry in elements(opened, "#chart-bunny .legend .traces")]
    assert set(names) == {*FAMILIES, "Pareto front"}
    toggle = elements(opened, "#chart-bunny .legend .legendtoggle")[names.index(FAMILIES[1])]
    toggle.click()
    wait_for(lambda: len(elements(opened, f"#chart-bunny {POINTS}")) == shown - 4 * 3)
    toggle.click()
    wait_for(lambda: len(elements(opened, f"#chart-bunny {POINTS}")) == shown)


def test_the_page_needs_nothing_from_elsewhere_and_names_what_failed(opened):
    loaded = opened.execute_script("return performance.getEntriesByType('resource').map(entry => entry.name)")
    assert [name for name in loaded if not name.startswith(("data:", "blob:"))] == []
    assert "jacobi: does not converge" in elements(opened, ".failed")[0].text
    assert "0123456789ab" in elements(opened, "body")[0].text
