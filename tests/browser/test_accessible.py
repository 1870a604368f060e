"""Accessibility of the workbench views and of a report, by axe."""

import json
from pathlib import Path
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, expect

from tests.browser.jupyter import dark
from tests.browser.onbench import open_tab, type_text, wait_until_refined
from tests.browser.staticpage import open_bench

RULES = {"runOnly": {"type": "tag", "values": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"]}}
SERIOUS = ("serious", "critical")


def findings(page: Page, within: str | None = ".thermicon") -> list[dict[str, Any]]:
    """What is serious or critical, with the elements."""
    found = Axe().run(page, context=within, options=RULES).response["violations"]
    return [
        {"rule": each["id"], "where": [node["html"][:160] for node in each["nodes"][:4]]}
        for each in found
        if each["impact"] in SERIOUS
    ]


def told(found: list[dict[str, Any]]) -> str:
    return json.dumps(found, indent=1, ensure_ascii=False)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_no_view_of_the_workbench_has_a_serious_finding(bench: Page, scheme: str) -> None:
    page = bench
    dark(page, scheme == "dark")
    wrong = {"design": findings(page)}
    ground = page.locator(".tm-root").first.evaluate("e => getComputedStyle(e).backgroundColor")
    assert (ground == "rgb(17, 17, 17)") == (scheme == "dark")
    for name in ("Open", "Save as", "?"):
        page.get_by_role("button", name=name, exact=True).click()
        page.wait_for_timeout(300)
        wrong[name] = findings(page, ".thermicon-project")
    page.get_by_role("button", name="?", exact=True).click()
    open_tab(page, "Set")
    wait_until_refined(page)
    page.wait_for_timeout(3000)
    wrong["set"] = findings(page)
    open_tab(page, "Export")
    page.get_by_label("icons", exact=True).select_option("the selected icon")  # six take longer to judge
    expect(page.locator(".thermicon-export")).to_contain_text("ready to be written")
    wrong["export"] = findings(page)
    open_tab(page, "Design")
    page.get_by_role("button", name="Sliders").click()
    page.get_by_role("button", name="Pin", exact=True).click()
    page.get_by_role("button", name="Insert ▾").click()
    expect(page.get_by_label("Icon of a shipped set")).to_contain_text("cooling-step")
    wrong["palette, pinned"] = findings(page)
    page.keyboard.press("Escape")
    for name in ("Play set", "Quiz"):
        page.get_by_role("button", name=name).click()
        expect(page.locator(".tm-reel")).to_be_visible()
        wrong[name] = findings(page)
    page.keyboard.press("Escape")
    page.locator(".tm-words summary").first.click()
    wrong["words"] = findings(page, ".tm-timeline")
    type_text(page, "cue 1; icon a { hold for 1 }")
    expect(page.locator(".tm-status")).to_contain_text("1 error")
    wrong["error"] = findings(page)
    wrong = {view: found for view, found in wrong.items() if found}
    assert wrong == {}, json.dumps(wrong, indent=1, ensure_ascii=False)


@pytest.mark.parametrize("key", ["distance", "confusion"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_numbers_can_be_read_on_every_shade_and_a_rough_matrix_says_so(page: Page, scheme: Any, key: str) -> None:
    page.emulate_media(color_scheme=scheme)
    made = open_bench(page)
    made.show("heat")
    one = {"key": key, "label": key, "buffer": 0, "unit": "", "low": 0, "high": 1, "text": "0%"}
    meta = {"type": "frame", "view": "heat", "labels": [f"i{k}" for k in range(16)], "matrices": [one]}
    made.frame({**meta, "rough": "rough: 12 people"}, [k / 255 for k in range(256)])
    expect(page.locator("figcaption")).to_contain_text("rough: 12 people")
    found = Axe().run(page, context=".tm-grid", options={"runOnly": ["color-contrast"]}).response
    assert found["violations"] == []
    judged = [node["html"] for each in found["passes"] for node in each["nodes"]]
    assert sum("tm-cell" in html for html in judged) == 256
    made.frame(meta, [k / 255 for k in range(256)])
    expect(page.locator("figcaption")).not_to_contain_text("rough")


def test_a_report_has_no_serious_finding(page: Page, tmp_path: Path) -> None:
    from typer.testing import CliRunner

    from thermicon.notebooks.cli.main import app

    cue = tmp_path / "two.cue"
    cue.write_text("cue 1\nicon a { cool by 3 K at 2 K/s; return at 2 K/s }\nicon b { pulse warm by 3 K for 2 s }\n")
    report = tmp_path / "report.html"
    done = CliRunner().invoke(app, ["rank", str(cue), "--people", "4", "--intervals", "0", "--report", str(report)])
    assert done.exit_code == 0, done.output
    page.goto(report.as_uri())
    found = findings(page, None)
    assert found == [], told(found)
