# %% [markdown]
# # What does an observed motion say of the kitchen?
#
# A track is a path of one point: a handle, a marker, a hand. It says which joint moves it, how surely, and
# whether the twin has that joint. Where it has not, the smallest change that would let the physics replay
# what was seen is proposed: one joint, and nothing is accepted by proposing it.

# %% tags=["parameters"]
kitchen = "b"  # bundled (a, b) or a path
track = ""  # file of a track: .csv, .log, .npz, .mcap; empty: one is made here of the container's handle
container = "iai_fridge_door"  # whose motion it is; empty (with a file only): the one that fits best
at = ""  # where the track's frame stands in the kitchen, X,Y,YAW; empty: they are one
state = ""  # joints elsewhere, as --state of sdt learn takes them, comma-separated
shift = 0.06  # a track that is made: by how much its joint is elsewhere, in m
noise = 0.002  # a track that is made: standard deviation in each direction, in m
seed = 0  # of that noise

# %%
from services.reports.studies import learning

options = {"at": at, "state": state, "shift": shift, "noise": noise, "seed": seed}
found = learning.lesson(kitchen, track, container=container, **options)
learning.candidates(found)

# %%
learning.track_figure(found)

# %% [markdown]
# ## In the kitchen
#
# The twin's own path is fitted to the same samples. It *fits* if, within the limits of the joint's position,
# it is as near to them as the noise of the track allows; the physics *replays* the motion if nothing else is
# in its way either.

# %%
learning.in_kitchen(found)

# %%
learning.view(found)

# %% [markdown]
# ## What the twin would have to say

# %%
learning.proposed(found)

# %% [markdown]
# A joint's limits are what was seen, not where it stops. `sdt learn TRACK --kitchen … --accept` writes the
# proposed twin as a branch; without it nothing changes.
