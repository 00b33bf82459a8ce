"""Calls of kernels that are compiled when they are first made, not with their caller.

A flight carries few members of each family.  Machine code that calls a kernel lazily holds a slot for its
address, empty when the code is loaded; the first call asks Python for the address, which compiles the kernel
or loads it from the cache, and later calls cost a load and an indirect jump.  No address is ever written to
disk.  What goes wrong when a kernel is compiled is raised by the flight.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typing import Signature
from numba.extending import intrinsic

#: Every lazy call of this process by name.
_calls: dict[str, LazyCall] = {}


@dataclass(frozen=True, eq=False)
class LazyCall:
    """A call of one of some kernels, chosen by its index.

    Attributes:
        name: unique in the process and the same in every process.
        kernels: by index.
        sections: for each kernel and argument the field of the argument that it gets, or ``None`` for all of
            it.
        returns: what every kernel returns.
    """

    name: str
    kernels: Sequence[Any]
    sections: Sequence[Sequence[str | None]]
    returns: types.Type
    typed: dict[tuple[types.Type, ...], None]

    def signature(self, index: int, given: Iterable[types.Type]) -> Signature:
        """Signature of a kernel for the types of the arguments that the call is given."""
        own = (
            kind if name is None else kind.typeof(name)
            for kind, name in zip(given, self.sections[index], strict=True)
        )
        return self.returns(*own)

    def compile(self, index: int, given: Iterable[types.Type]) -> Any:
        """Machine code of a kernel, from the cache or new."""
        return self.kernels[index].get_compile_result(self.signature(index, given))


def address_of(name: str, given: tuple[types.Type, ...], index: int) -> int:
    """Address of a kernel's machine code; compiled code asks for it."""
    code = _calls[name].compile(index, given)
    return code.library.get_pointer_to_function(code.fndesc.llvm_func_name)


def lazy_call(
    name: str, kernels: Sequence[Any], sections: Sequence[Sequence[str | None]], returns: types.Type
) -> Any:
    """Function ``call(index, arguments)`` for kernels (``arguments``: a tuple) that calls kernel ``index``."""
    lazy = _calls[name] = LazyCall(name, kernels, sections, returns, {})

    @intrinsic
    def call(
        _typing: Any, index: types.Type, arguments: types.BaseTuple
    ) -> tuple[Signature, Callable[..., Any]]:
        given = tuple(types.unliteral(kind) for kind in arguments)
        lazy.typed[given] = None

        def generate(context: Any, builder: Any, _signature: Signature, values: Any) -> Any:
            chosen = _within(builder, values[0], len(kernels))
            passed = _own(context, builder, lazy, given, chosen, cgutils.unpack_tuple(builder, values[1]))
            address = _address(context, builder, lazy, given, chosen)
            return _invoke(context, builder, lazy.signature(0, given), address, passed)

        return returns(types.intp, types.Tuple(given)), generate

    return call


def _within(builder: Any, index: Any, count: int) -> Any:
    """An index that no kernel has becomes 0."""
    return builder.select(builder.icmp_unsigned("<", index, index.type(count)), index, index.type(0))


def _own(
    context: Any,
    builder: Any,
    lazy: LazyCall,
    given: tuple[types.Type, ...],
    index: Any,
    values: Sequence[Any],
) -> list[Any]:
    """The arguments as the kernel gets them: where it gets a field alone, the address of that field."""
    own = []
    for i, (kind, value) in enumerate(zip(given, values, strict=True)):
        fields = [sections[i] for sections in lazy.sections]
        if fields[0] is not None:
            offsets = [kind.offset(field) for field in fields]
            table = cgutils.global_constant(
                builder, f"{lazy.name}.{i}", ir.Constant(ir.ArrayType(index.type, len(offsets)), offsets)
            )
            offset = builder.load(cgutils.gep_inbounds(builder, table, 0, index))
            field = cgutils.pointer_add(builder, value, offset)
            value = builder.bitcast(field, context.get_argument_type(kind.typeof(fields[0])))
        own.append(value)
    return own


def _address(context: Any, builder: Any, lazy: LazyCall, given: tuple[types.Type, ...], index: Any) -> Any:
    """Address of the kernel, from its slot or, on the first call, from Python."""
    slots = cgutils.add_global_variable(
        builder.module, ir.ArrayType(cgutils.voidptr_t, len(lazy.kernels)), f"{lazy.name}.slots"
    )
    slots.initializer = ir.Constant(slots.type.pointee, None)
    slots.linkage = "internal"
    slot = cgutils.gep_inbounds(builder, slots, 0, index)
    with cgutils.if_unlikely(builder, cgutils.is_null(builder, builder.load(slot))):
        python = context.get_python_api(builder)
        state = python.gil_ensure()
        module = python.import_module(context.insert_const_string(builder.module, __name__))
        ask = python.object_getattr_string(module, address_of.__name__)
        what = python.unserialize(python.serialize_object((lazy.name, given)))
        name, kinds = python.tuple_getitem(what, 0), python.tuple_getitem(what, 1)
        number = python.long_from_longlong(index)
        answer = python.call_function_objargs(ask, (name, kinds, number))
        failed = cgutils.is_null(builder, answer)
        with builder.if_then(builder.not_(failed)):
            builder.store(python.long_as_voidptr(answer), slot)
            python.decref(answer)
        for one in (number, what, ask, module):
            python.decref(one)
        python.gil_release(state)
        with cgutils.if_unlikely(builder, failed):
            context.call_conv.return_exc(builder)
    return builder.load(slot)


def _invoke(context: Any, builder: Any, signature: Signature, address: Any, arguments: Sequence[Any]) -> Any:
    """Call machine code by its address; an exception goes on to the caller."""
    convention = context.call_conv
    kind = convention.get_function_type(signature.return_type, signature.args)
    status, result = convention.call_function(
        builder, builder.bitcast(address, kind.as_pointer()), signature.return_type, signature.args, arguments
    )
    with cgutils.if_unlikely(builder, status.is_error):
        convention.return_status_propagate(builder, status)
    return result
