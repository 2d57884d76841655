# %% [markdown]
# # Which change of the kitchen helps which robot?
#
# Every container, for every robot, in every combination of changes. A change that helps one robot may take
# something from another, so the worlds are counted as wholes. Where a change touches nothing that a verdict
# rests on, the motion is certified again in the changed kitchen instead of being searched again.

# %% tags=["parameters"]
kitchen = "b"  # bundled (a, b) or a path
robots = "pr2,stretch"  # bundled names or paths, comma-separated
task = "open:sink_area_dish_washer_door,oven_area_oven_door"  # open or close, of all containers or of some
edits = "set:sink_area_dish_washer_door_joint.upperLimit=1.2; box:crate=0.3,0.3,0.4@0.6,0.6,0.2"  # axes by ;
state = ""  # joints elsewhere, as --state of sdt whatif takes them, comma-separated
drive = ""  # omni (the paper's), differential, fixed; empty: as each robot's hardware
friction = ""  # with which coefficient fingers rub on handles; empty: verdicts say which their holds need
budget = 6.0  # seconds of search for each container
jobs = 2  # processes that judge
store = ""  # where verdicts about the kitchen as it is are read from and kept; empty: nowhere

# %%
from services.reports.studies import codesign

options = {"state": state, "drive": drive, "friction": friction, "budget": budget, "store": store}
found = codesign.covered(kitchen, robots, task, edits, jobs=jobs, **options)
codesign.counts(found)

# %%
codesign.figure(found)

# %% [markdown]
# ## What turns
#
# A verdict that is lost counts as much as one that is won.

# %%
codesign.turned(found)

# %% [markdown]
# ## The best of these worlds
#
# The one with the most certificates, and among equals the one with the fewest changes.

# %%
codesign.view(found)

# %%
codesign.matrix(found)

# %%
codesign.reuse(found)

# %%
codesign.verdicts(found)

# %% [markdown]
# The best of these worlds is the best of those that were listed, and no more: an edit that is not on an axis
# was not tried. A field that is not certified and not proved may be certified with more seconds.
#
# Edits are as `sdt whatif` takes them: axes separated by `;`, the alternatives of one axis by `|`.
