'''thermicon: write thermal icons, see what display, skin and receptors do, and predict which of them people confuse.

    from thermicon import parse, perceive, rank, simulate

    icons = parse("""cue 1
    icon dip  { cool by 4 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
    icon glow { warm by 3 °C at 1 °C/s; hold for 2 s; return at 1 °C/s }""")
    trace = simulate(icons["dip"], "thenar", tail_s=10)  # display, skin and receptors against time
    percept = perceive(trace)  # what a nominal person feels of it
    ranking = rank(icons, "thenar", people=50)  # what people confuse
    print(trace, percept, ranking, sep="\\n")

Sets, rigs and devices are named wherever they are needed: load_library("six-icons") and Rig.load("thenar") are the
objects, and a file of your own has a name too. A wrong argument is an InputError that says what it takes. Results show
themselves as pictures in a notebook, and have plot() and, where there is a table, to_frame() and to_csv(path).

thermicon.icons: cue text, code and recordings become icons
    parse, read_cue, load_library, library      cue text, a file, a shipped set, the list of them
    cool, warm, ramp, hold, rest, back, step, pulse, wave, repeat, play, current, total      statements in code
    Icon.of("dip", cool(by=4, at=2), back(at=2), control="display", baseline_C=32)      by 4 K at 2 K/s, and back
    IconSet.of([dip, glow]).save("two.cue")     read_cue reads it back equal
    from_samples(time_s, temperature_C), from_csv(path)      a recording as an icon
    Family, format_text, to_json, CueErrors

thermicon.circuit: icons on a rig become current, temperatures, heat flow and exported drives
    simulate(icon, rig).to_csv("trace.csv"), simulate_many, simulate_current, design, nearest_reachable
    Rig.load("thenar").with_set(["contact.area_cm2=4"]).save("mine.toml")      a key changed; about() describes a rig
    fit(frame, rig, free="contact.resistance_m2K_per_W").rig      a rig from a table with time_s, current_A, display_C
    export(icons, rig, "dac-16", folder="drives"), netlist, Device, Export      refused where it is not safe
    gate, play_session, SessionPlan, Session, Gate, Limits, Drive, read_drive, Trace, Outcome, InputError

thermicon.perception: temperatures become sensations, confusions and a ranking
    rank(icons, rig, people=50).to_frame(), Ranking, Crowd, Task, perceive, Percept, plot
    choose(ranking, Selection(3)), cheapest_edit, frontier, search, judge_goal, Goal      better sets
    plan, observed, Trials, read_trials, read_measurements      an experiment before and after it
    measure, Condition, Measurement, Observer, draw_people, confuse, Confusion, information_bits, validate

thermicon.notebooks: what people touch: command line, reports, figures, studies, workbench
    sweep(icons, rig, "contact.area_cm2", [1, 4, 9])      a table, one row per icon and value of a key of the rig
    overview(trace, percept), Workbench("two.cue")

help(thermicon.icons) has all of a package, help(thermicon.rank) one name, dir(thermicon) those that are here too.
'''

import sys
from contextlib import suppress

with suppress(ImportError):  # where it is missing, ``thermicon doctor`` has to say so
    from lazy_loader import attach_stub

    __getattr__, _, __all__ = attach_stub(__name__, __file__)


def __dir__() -> list[str]:
    """All names; but for `help`, which would print the whole text of each, the packages alone."""
    asking = sys._getframe(1)
    while asking.f_back and asking.f_globals["__name__"] == "inspect":
        asking = asking.f_back
    return ["icons", "circuit", "perception", "notebooks"] if asking.f_code.co_name == "docmodule" else list(__all__)
