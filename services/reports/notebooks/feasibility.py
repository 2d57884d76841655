# %% [markdown]
# # Which robot achieves what in this kitchen?
#
# A task is *certified* when three predicates hold: the final state meets the request (SatisfiesRequest),
# the physics under the motion ends there (Causes), and the robot can do it inside its limits and without
# collision (CanPerform). Each verdict is about one robot and one container, all else as the parameters say.

# %% tags=["parameters"]
kitchen = "a"  # bundled (a, b) or a path
robots = "pr2,tiago_dual,stretch"  # bundled names or paths, comma-separated
task = "open"  # open or close, of all containers; or open:NAME,NAME
state = ""  # joints elsewhere, as --state of sdt table takes them, comma-separated; else everything is closed
drive = ""  # omni (the paper's), differential, fixed; empty: as each robot's hardware
friction = ""  # with which coefficient fingers rub on handles; empty: verdicts say which their holds need
budget = 20.0  # seconds of search for each container
store = ""  # where verdicts are read from and kept; empty: nowhere
jobs = 2  # processes that judge what is not stored

# %%
from services.reports.studies import feasibility
from services.reports.studies.judged import judged

options = {"state": state, "drive": drive, "friction": friction, "budget": budget, "store": store}
found = judged(kitchen, robots, task, **options, jobs=jobs)
feasibility.counts(found)

# %% [markdown]
# ## The kitchen, and every certified motion
#
# Each motion was checked by code that did not plan it: limits of position, velocity and acceleration, and
# every distance, between the samples too. Choose one below, or in the matrix after it, and press *Play*.

# %%
view = found.view()
view

# %%
feasibility.matrix(found)

# %%
feasibility.matrix_figure(found)

# %% [markdown]
# ## How much room is left
#
# A certificate is about the models, so what it leaves matters: how near the robot comes to anything, and
# how far base and handle may be from where the twin has them before the certificate says nothing.

# %%
feasibility.margins(found)

# %%
feasibility.durations(found)

# %% [markdown]
# ## What is not certified, and why
#
# *Proved*: a sound bound excludes every motion of the class. *Measured*: the motion that was made breaks a
# bound. *Not proved*: the search gave up, which denies nothing: more seconds or another start may do it.

# %%
feasibility.refusals(found)

# %%
feasibility.picture(view)

# %% [markdown]
# All of this is relative to D_artic: rigid bodies and their kinematics, no forces, no friction, no error of
# perception; and to the kitchen's and the robots' models.
