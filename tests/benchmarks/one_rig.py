"""A rig that is used again, as in a notebook, for ``saved_by_caches.py``, which takes this file as a command.

Single commands take each rig once; here every icon of a set is simulated, and its current played, 200 times.
"""

from thermicon.circuit import Drive, Rig, simulate, simulate_current
from thermicon.icons import load_library

rig = Rig.load("thenar")
for depth in range(200):
    for icon in load_library("six-icons"):
        simulate(icon, rig)
    simulate_current(Drive([0.0, 1.0, 4.0], [0.0, 0.001 * depth, 0.0]), rig)
