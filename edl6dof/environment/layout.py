"""Record layouts that carry derived arrays beside the parameters they are computed from."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import BaseModel

from edl6dof.config.dtype import dtype_of


def extended(model: type[BaseModel], **fields: Any) -> np.dtype:
    """The aligned dtype of ``model`` with ``fields`` (name = dtype) added, or put in place of fields of the
    same name.
    """
    base = dtype_of(model)
    layout = {name: base[name] for name in base.names or ()}
    layout.update({name: np.dtype(kind) for name, kind in fields.items()})
    return np.dtype(list(layout.items()), align=True)
