# %% [markdown]
# # What would have to be different?
#
# The same task in the world as it is and in others: another handle, another limit, something in the way. Each
# edit is made in the twin, so that physics, scope and planning all see it. A verdict that turns shows on what
# it rested; one that stays shows that it rested on something else.

# %% tags=["parameters"]
kitchen = "b"  # bundled (a, b) or a path
robots = "pr2,stretch"  # bundled names or paths, comma-separated
task = "open:iai_fridge_door"  # open:NAME or close:NAME
edits = "set:iai_fridge_door_joint.upperLimit=1.2; jam:iai_fridge_door"  # by ;
together = False  # whether all edits make one other world, instead of one each
turn = "move:iai_fridge_door=1.5"  # of which the smallest share is searched
steps = 2  # of the first scan of that share
tolerance = 0.1  # to which the share is told
state = ""  # joints elsewhere, as --state of sdt whatif takes them, comma-separated
base = ""  # where the robots start, X,Y,YAW; empty: as the kitchen says
drive = ""  # omni (the paper's), differential, fixed; empty: as each robot's hardware
friction = ""  # with which coefficient fingers rub on handles; empty: verdicts say which their holds need
budget = 8.0  # seconds of search for each verdict
store = ""  # where verdicts are read from and kept; empty: nowhere

# %%
from IPython.display import display

from services.reports.studies import counterfactual, turning

options = {"state": state, "base": base, "drive": drive, "friction": friction, "budget": budget}
search = {"turn": turn, "steps": steps, "tolerance": tolerance}
found = counterfactual.judged(
    kitchen, robots, task, edits, together=together, store=store, **search, **options
)
counterfactual.outcomes(found)

# %%
counterfactual.turned(found)

# %% [markdown]
# ## The worlds
#
# Each world in which something is certified, with the motions.

# %%
views = counterfactual.views(found)
for view in views:
    display(view)

# %%
counterfactual.picture(views)

# %% [markdown]
# ## How much of a change is needed?
#
# A change that has a half is made little by little, until the outcome turns; then the interval is halved.

# %%
turning.turning_figure(found.turnings)

# %%
turning.turnings(found.turnings)

# %% [markdown]
# An outcome that is certified in another world says what the kitchen, the robot or the task would have to be.
# One that is refused there, and not proved, says only that the search found nothing in its time: the same
# change with more seconds may turn it.
