# %% [markdown]
# # Why is this motion certified, or why not?
#
# One robot, one task, one verdict. The motion is read from a file; or it is the one that was certified
# before the kitchen was edited; or, with neither, the one that the planner looks for. Every reason has a
# quantity, its value and its bound, and most have a moment.

# %% tags=["parameters"]
kitchen = "b"  # bundled (a, b) or a path
robot = "pr2"  # bundled name or path
task = "open:iai_fridge_door"  # open:NAME or close:NAME
edits = ""  # what has changed since, box:crate=0.3,0.3,0.4@0.6,-0.6,0.2 say (sdt whatif --edit help), by ;
motion = ""  # file of a motion to judge: .npz, .json, .csv, .mcap
state = ""  # joints elsewhere, as --state of sdt achieve takes them, comma-separated
base = ""  # where the robot starts, X,Y,YAW; empty: as the kitchen says
drive = ""  # omni (the paper's), differential, fixed; empty: as the robot's hardware
friction = ""  # with which coefficient fingers rub on handles; empty: verdicts say which their holds need
budget = 20.0  # seconds of search
store = ""  # where verdicts are read from and kept; empty: nowhere

# %%
from services.reports.studies import diagnosis

how = {"state": state, "base": base, "drive": drive, "friction": friction, "budget": budget}
found = diagnosis.diagnosed(kitchen, robot, task, edits=edits, motion=motion, store=store, **how)
diagnosis.headline(found)

# %% [markdown]
# ## The motion, and where it fails
#
# Each moment at which a reason lies, the robot as a ghost; then the whole motion.

# %%
view = diagnosis.view(found)
view

# %%
diagnosis.evidence(found)

# %% [markdown]
# ## Along the motion
#
# A value at a moment says little without what comes before and after it.

# %%
diagnosis.course(found)

# %% [markdown]
# ## The whole story

# %%
diagnosis.story(found)

# %%
diagnosis.margins(found)

# %%
diagnosis.picture(view)

# %% [markdown]
# A reason that is *measured* or *proved* stands. A search that gave up is a reason to look further, not a
# proof: more seconds, another start or another grasp may do it.
