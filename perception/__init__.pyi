# The names of this package in the order of the flow; each is imported when it is first asked for.
from .observer.observer import Observer as Observer
from .observer.observer_model import Crowd as Crowd
from .observer.people import draw_people as draw_people
from .sensation.percept import perceive as perceive, Percept as Percept
from .experiments.measure import Condition as Condition, Measurement as Measurement, measure as measure
from .identification.confusion import confuse as confuse, Confusion as Confusion
from .identification.measures import information_bits as information_bits
from .identification.task import Task as Task
from .ranking.rank import rank as rank
from .ranking.ranking import Ranking as Ranking
from .selection.goal import Goal as Goal
from .selection.goal_result import judge_goal as judge_goal
from .selection.request import Selection as Selection
from .selection.choose import choose as choose
from .selection.edit import cheapest_edit as cheapest_edit
from .selection.frontier import frontier as frontier
from .selection.search import search as search
from .pilot.plan import plan as plan
from .pilot.trials import Trials as Trials
from .pilot.trials_file import read_trials as read_trials
from .pilot.measurements_file import read_measurements as read_measurements
from .pilot.observed import observed as observed
from .evidence.validate import validate as validate
from .plots.plot import plot as plot
