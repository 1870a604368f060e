"""How fast a drag is in a real browser, with the model running: from a hand's move to curves that are drawn."""

from __future__ import annotations

import time

import numpy
import pytest
from playwright.sync_api import Page, expect

from tests.browser.onbench import FIRST_HANDLE, root, type_text

pytestmark = pytest.mark.benchmark

# Its run has 3,000 rows.
LONG = """cue 1
icon long {
  cool by 4 °C at 0.5 °C/s
  hold for 8 s
  return at 1 °C/s
}
"""
P95_MS, OLDEST_MS = 60.0, 100.0
DRAGGED = """(from) => window.__thermicon.design.filter(({ drawn_ms, sent_ms }) => drawn_ms > from && sent_ms).map(
  ({ seq, sent_ms, drawn_ms }) =>
    ({ whole: drawn_ms - sent_ms, age: performance.timeOrigin + drawn_ms - seq }))"""


def test_a_drag_at_30_Hz(bench: Page) -> None:
    type_text(bench, LONG)
    expect(root(bench)).to_have_attribute("data-icon", "long")
    bench.wait_for_timeout(500)
    x, y = bench.evaluate(FIRST_HANDLE)
    bench.mouse.move(x, y)
    bench.mouse.down()
    began = bench.evaluate("performance.now()")
    start = time.monotonic()
    for step in range(150):
        bench.mouse.move(x + 0.15 * step, y - 8 * numpy.sin(step / 8))
        time.sleep(max(0.0, start + step / 30 - time.monotonic()))
    bench.mouse.up()
    bench.wait_for_timeout(500)
    frames = bench.evaluate(DRAGGED, began)[2:]
    whole, age = ([frame[name] for frame in frames] for name in ("whole", "age"))
    assert numpy.percentile(whole, 95) <= P95_MS
    assert max(age) <= OLDEST_MS
