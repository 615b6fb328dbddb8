# %% [markdown]
# # Glints in a notebook
# A script with cell marks: VS Code, Spyder and Jupytext open it as a notebook, and `python notebook.py` runs it.

# %%
import numpy as np

import mica

mica.devices()

# %% [markdown]
# ## A surface, and what a pixel sees of it

# %%
flakes = mica.NormalMap.generate("flakes", resolution=512)
evaluator = mica.Evaluator(flakes, tolerance=0.01)
image = evaluator.pndf([[0.5, 0.5]], sigma=8, roughness=0.02, size=128)[0]
mica.Image({"D": image / np.percentile(image[image > 0], 99.5)})

# %% [markdown]
# ## What it is made of
# The P-NDF integrates to the share of the footprint's normals that the window shows.

# %%
share = image.sum() * (2 / 128) ** 2
print(f"the pixels hold {share:.4g} of the normals")
print("\n".join(evaluator.choices))

# %% [markdown]
# ## A picture

# %%
job = mica.Job(
    {
        "image": {"width": 160, "height": 90, "subpixels": 2},
        "camera": {"position": [0, -3.2, 1.4], "look_at": [0, 0, 0.45], "fov": 24},
        "surface": {"bumps": {"generate": "spectrum", "resolution": 256, "rms_slope": 0.3, "correlation": 8}},
        "material": {"gold": {"surface": "bumps", "repeat": [6, 6], "specular": {"color": [1, 0.8, 0.4]}}},
        "shape": [{"type": "shell", "material": "gold"}],
        "light": [{"type": "point", "position": [1.6, -3.6, 3.4], "intensity": [25, 25, 25]}],
    }
)
print(job.plan())
picture = job.render()
picture
