"""The site that tools/docs builds: without a warning, from nothing of the network, and fit to be looked at."""

from __future__ import annotations

import functools
import http.server
import re
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from shell_pages import ROOT, environment, parser

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("mkdocstrings", reason="the extra docs is not installed: run tools/setup")
pytest.importorskip("material", reason="the extra docs is not installed: run tools/setup")

SCREENS = {"desktop": (1400, 1000, "light"), "phone": (390, 844, "dark")}
# Pages with what could be too wide: pictures, formulae, tables, usages, signatures, long lines of code.
SOME = ("index.html", "physics.html", "tables.html", "reference/commands.html", "reference/python.html", "start.html")
SCHEMES = {"light": "default", "dark": "slate"}
# Of a page: how much wider than the screen it is, pictures that did not load, and where its files came from.
LOOK = """
const page = document.documentElement;
const broken = [...document.images].filter(image => image.complete && image.naturalWidth === 0).map(image => image.src);
const waiting = [...document.images].filter(image => !image.complete).length;
const from = performance.getEntriesByType('resource').map(entry => entry.name);
return {wider: page.scrollWidth - page.clientWidth, broken, waiting, from,
        scheme: document.body.getAttribute('data-md-color-scheme')};
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """The site, built; a warning is an error."""
    folder = tmp_path_factory.mktemp("docs") / "site"
    built = subprocess.run(
        [ROOT / "tools/docs", "--site-dir", folder],
        env=environment(folder.parent),
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert built.returncode == 0, built.stderr
    assert built.stdout + built.stderr == ""
    return folder


@pytest.fixture(scope="module")
def address(site) -> Iterator[str]:
    """Where a server of this machine has the site."""

    class Silent(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_words: object) -> None:
            """Say nothing."""

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Silent, directory=str(site)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()


def wait_for(condition: Callable[[], object], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "the page did not get there"
        time.sleep(0.05)


def pages(site: Path) -> list[str]:
    return sorted(path.relative_to(site).as_posix() for path in site.rglob("*.html"))


def on_screen(browser, screen: str) -> str:
    """Give the browser a screen; the scheme of colours that pages are to have there."""
    width, height, scheme = SCREENS[screen]
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": screen == "phone"}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    wanted = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", wanted)
    return SCHEMES[scheme]


def test_the_navigation_has_every_page(site):
    """Whatever lies in docs/, and the pages that the hooks make."""
    wanted = {path.relative_to(ROOT / "docs").with_suffix(".html").as_posix() for path in ROOT.glob("docs/**/*.md")}
    wanted = {name.replace("README.html", "index.html") for name in wanted}
    wanted |= {f"reference/{name}.html" for name in ("commands", "python", "scene")}
    assert wanted <= set(pages(site))


def test_every_link_leads_to_a_page_and_a_place_in_it(site):
    """Also those that the theme makes; other sites are not asked."""
    places = {name: set(re.findall(r'\bid="([^"]+)"', (site / name).read_text())) for name in pages(site)}
    wrong = []
    for name in places:
        for target in re.findall(r'\b(?:href|src)="([^"]+)"', (site / name).read_text()):
            parts = urlsplit(target)
            if parts.scheme or parts.netloc or name == "404.html":
                continue
            path = ((site / name).parent / unquote(parts.path)).resolve() if parts.path else site / name
            path = path / "index.html" if path.is_dir() else path
            known = places.get(path.relative_to(site).as_posix())
            if not path.is_file() or (parts.fragment and known is not None and unquote(parts.fragment) not in known):
                wrong.append(f"{name}: {target}")
    assert wrong == []


def test_the_reference_has_every_command_option_and_name(site):
    text = (site / "reference/commands.html").read_text()
    (subcommands,) = [action.choices for action in parser()._actions if action.dest == "command"]
    for name, command in subcommands.items():
        assert f"quadgraph {name}<" in text
        declare, command.declare = command.declare, None
        if declare is not None:
            declare(command)
        options = {option for action in command._actions for option in action.option_strings}
        assert not [option for option in options if f"<code>{option}" not in text]
    python = (site / "reference/python.html").read_text()
    for name in re.findall(r"^\[(\w+)\]$", (ROOT / "docs/public_api.toml").read_text(), re.MULTILINE):
        assert re.search(rf'id="[\w.]+\.{name}"', python), name


def test_formulae_are_drawn_by_the_browser(site):
    physics = (site / "physics.html").read_text()
    assert physics.count("<math") > 100
    assert "$`" not in physics
    assert "language-math" not in physics


@pytest.mark.parametrize("screen", SCREENS)
@pytest.mark.parametrize("names", [SOME, pytest.param((), marks=pytest.mark.long, id="all")])
def test_pages_fit_the_screen(site, address, browser, screen, names, tmp_path):
    """Nothing is wider than the screen, all pictures load, all comes from the site, nothing complains."""
    browser.get("about:blank")
    kept = {"origin": address, "storageTypes": "local_storage"}  # the scheme of the screen before
    browser.execute_cdp_cmd("Storage.clearDataForOrigin", kept)
    scheme = on_screen(browser, screen)
    browser.get_log("browser")
    faults = {}
    for name in names or [name for name in pages(site) if name != "404.html"]:
        browser.get(f"{address}/{name}")
        wait_for(lambda: browser.execute_script(LOOK)["waiting"] == 0)
        seen = browser.execute_script(LOOK)
        elsewhere = [source for source in seen["from"] if not source.startswith((address, "data:", "blob:"))]
        found = [seen["wider"] > 0 and f"{seen['wider']} pixels too wide", seen["broken"], elsewhere]
        found += [seen["scheme"] != scheme and f"scheme {seen['scheme']}", browser.get_log("browser")]
        if any(found):
            browser.save_screenshot(str(tmp_path / f"{name.replace('/', '-')}.png"))
            faults[name] = [each for each in found if each]
    assert faults == {}


@pytest.mark.parametrize("where", ["a server", "the disk"])
def test_the_search_finds_a_page(where, site, address, browser):
    on_screen(browser, "desktop")
    browser.get(f"{site.as_uri() if where == 'the disk' else address}/index.html?q=orange")
    wait_for(lambda: browser.execute_script("return document.querySelectorAll('.md-search-result__item').length") > 0)
    links = browser.execute_script(
        "return [...document.querySelectorAll('.md-search-result__item a')].map(link => link.getAttribute('href'))"
    )
    assert any("faq.html" in link for link in links)


def test_a_page_that_is_not_there_is_left_out_of_the_navigation(site):
    """The navigation may name pages that are yet to be written."""
    names = re.findall(r":\s(\S+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.MULTILINE)
    missing = [name for name in names if not (site / name).with_suffix(".html").is_file()]
    index = (site / "index.html").read_text()
    assert not [name for name in missing if f'href="{name.replace(".md", ".html")}"' in index]
