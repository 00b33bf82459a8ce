"""Text of DAVE-ML files made for tests, and the one problem of a file that is refused."""

import pytest

from edl6dof.config.errors import ConfigError
from edl6dof.interchange.daveml import read_daveml

HEAD = '<?xml version="1.0"?>\n<DAVEfunc xmlns="http://daveml.org/2010/DAVEML">\n'


def write(folder, body, name="model.dml", head=HEAD):
    path = folder / name
    path.write_text(f"{head}{body}\n</DAVEfunc>\n", encoding="utf-8")
    return path


def variable(name, value=None, inner="", identifier=None, units="nd"):
    initial = "" if value is None else f' initialValue="{value}"'
    attributes = f'name="{name}" varID="{identifier or name}" units="{units}"{initial}'
    return f"<variableDef {attributes}>{inner}</variableDef>\n"


def calculated(name, math, **more):
    return variable(
        name,
        inner=f'<calculation><math xmlns="http://www.w3.org/1998/Math/MathML">{math}</math></calculation>',
        **more,
    )


def refusal(path, action=read_daveml):
    with pytest.raises(ConfigError) as error:
        action(path)
    (problem,) = error.value.problems
    assert problem.file.endswith(path.name)
    return problem


def apply(operator, *arguments):
    """An operation of MathML."""
    return f"<apply><{operator}/>{''.join(arguments)}</apply>"


def table(name, inputs, axes, values, output):
    """A function over a gridded table of its own."""
    points = "".join(
        f'<breakpointDef bpID="{name}{k}"><bpVals>{axis}</bpVals></breakpointDef>\n'
        for k, axis in enumerate(axes)
    )
    references = "".join(f'<bpRef bpID="{name}{k}"/>' for k in range(len(axes)))
    grid = f"<breakpointRefs>{references}</breakpointRefs><dataTable>{values}</dataTable>"
    over = "".join(f'<independentVarRef varID="{key}"/>' for key in inputs)
    return (
        f'{points}<function name="{name}">{over}<dependentVarRef varID="{output}"/>'
        f'<functionDefn><griddedTableDef gtID="{name}_T">{grid}</griddedTableDef></functionDefn></function>\n'
    )
