"""Calls of kernels that are compiled when they are first made, not with their callers.

A flight carries few members of each family, and numba compiles what is called from many places again in each.
Machine code that calls a kernel lazily holds an empty slot for its address; the first call asks Python for
it, which compiles the kernel or loads it from the cache, and each later call costs a load and an indirect
jump.  No address is written to disk, and what goes wrong when a kernel is compiled is raised by the flight.
"""

from __future__ import annotations

import pickle
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.serialize import dumps
from numba.core.typing import Signature
from numba.extending import intrinsic

#: The lazy calls of this process by name.
_calls: dict[str, LazyCall] = {}


class LazyCall:
    """A call of one of some kernels by index."""

    def __init__(
        self,
        name: str,
        kernels: Sequence[Any],
        sections: Sequence[str],
        own: Sequence[bool],
        returns: types.Type,
    ) -> None:
        """
        Args:
            name: the same in every process, and unique.
            kernels: by index.
            sections: names of their sections by index.
            own: for each argument whether it holds a section for each kernel, which gets its own alone.
            returns: what every kernel returns.

        Raises:
            ValueError: the name is taken.
        """
        if name in _calls:
            raise ValueError(f"there is a lazy call named {name!r} already")
        self.name, self.kernels, self.sections = name, kernels, sections
        self._own, self._returns = own, returns
        #: Types of the arguments of the calls that were compiled in this process.
        self.given: set[tuple[types.Type, ...]] = set()
        _calls[name] = self

    def compile(self, index: int, given: tuple[types.Type, ...]) -> Any:
        """Machine code of a kernel for the types of the call's arguments, from the cache or new."""
        return self.kernels[index].get_compile_result(self.signature(index, given))

    def signature(self, index: int, given: tuple[types.Type, ...]) -> Signature:
        """Signature of a kernel for the types of the call's arguments."""
        kinds: Any = zip(given, self._own, strict=True)
        return self._returns(*(kind.typeof(self.sections[index]) if own else kind for kind, own in kinds))

    def intrinsic(self) -> Any:
        """Function ``call(index, arguments)`` for kernels; ``arguments``: a tuple."""

        @intrinsic
        def call(_: Any, _index: types.Type, arguments: types.Tuple) -> tuple[Signature, Callable[..., Any]]:
            given = tuple(types.unliteral(kind) for kind in arguments.types)
            self.given.add(given)

            def generate(context: Any, builder: Any, _: Signature, values: Sequence[Any]) -> Any:
                index = _within(builder, values[0], len(self.kernels))
                passed = cgutils.unpack_tuple(builder, values[1])
                for i, (kind, own) in enumerate(zip(given, self._own, strict=True)):
                    if own:
                        passed[i] = self._section(context, builder, kind, passed[i], index)
                address = self._address(context, builder, given, index)
                return _invoke(context, builder, self.signature(0, given), address, passed)

            return self._returns(types.intp, types.Tuple(given)), generate

        return call

    def _section(self, context: Any, builder: Any, kind: types.Record, record: Any, index: Any) -> Any:
        """The section of a record that belongs to the kernel."""
        offsets = [index.type(kind.offset(name)) for name in self.sections]
        table = cgutils.global_constant(
            builder, f"{self.name}.offsets", ir.Constant(ir.ArrayType(index.type, len(offsets)), offsets)
        )
        offset = builder.load(cgutils.gep_inbounds(builder, table, 0, index))
        wanted = context.get_argument_type(kind.typeof(self.sections[0]))
        return builder.bitcast(cgutils.pointer_add(builder, record, offset), wanted)

    def _address(self, context: Any, builder: Any, given: tuple[types.Type, ...], index: Any) -> Any:
        """Address of the kernel: from its slot or, in the first call, from :func:`address_of`."""
        slots = cgutils.add_global_variable(
            builder.module, ir.ArrayType(cgutils.voidptr_t, len(self.kernels)), f"{self.name}.slots"
        )
        slots.initializer, slots.linkage = ir.Constant(slots.type.pointee, None), "internal"
        slot = cgutils.gep_inbounds(builder, slots, 0, index)
        with cgutils.if_unlikely(builder, cgutils.is_null(builder, builder.load(slot))):
            python = context.get_python_api(builder)
            lock = python.gil_ensure()
            module = python.import_module(context.insert_const_string(builder.module, __name__))
            ask = python.object_getattr_string(module, address_of.__name__)
            # hundreds of fields in each record: packed, a tenth of the size
            what = python.unserialize(python.serialize_object((self.name, zlib.compress(dumps(given)))))
            which = python.long_from_longlong(index)
            answer = python.call_function_objargs(ask, (what, which))
            failed = cgutils.is_null(builder, answer)
            with builder.if_then(builder.not_(failed)):
                builder.store(python.long_as_voidptr(answer), slot)
                python.decref(answer)
            for one in (which, what, ask, module):
                python.decref(one)
            python.gil_release(lock)
            with cgutils.if_unlikely(builder, failed):
                context.call_conv.return_exc(builder)
        return builder.load(slot)


def address_of(what: tuple[str, bytes], index: int) -> int:
    """Address of the machine code of kernel ``index`` of a call; compiled code asks for it."""
    name, given = what
    code = _calls[name].compile(index, pickle.loads(zlib.decompress(given)))
    address: int = code.library.get_pointer_to_function(code.fndesc.llvm_func_name)
    return address


def names() -> set[str]:
    """What the kernels of all lazy calls go by."""
    return {name for call in _calls.values() for name in call.sections}


def compile_named(chosen: Iterable[str]) -> None:
    """Compile the kernels that go by these names, one name after the other, for all lazy calls compiled so
    far in this process; and then for those that these kernels make.
    """
    named, done = list(chosen), set[tuple[str, str, tuple[types.Type, ...]]]()
    while ahead := [one for one in _open_calls(named) if one not in done]:
        for name, call, given in ahead:
            _calls[call].compile(_calls[call].sections.index(name), given)
        done.update(ahead)


def _open_calls(named: Iterable[str]) -> Iterator[tuple[str, str, tuple[types.Type, ...]]]:
    """Name of a kernel, name of the lazy call and types of its arguments."""
    for name in named:
        for call in _calls.values():
            if name in call.sections:
                yield from ((name, call.name, given) for given in call.given)


def _within(builder: Any, index: Any, count: int) -> Any:
    """An index, 0 where there is no such kernel."""
    return builder.select(builder.icmp_unsigned("<", index, index.type(count)), index, index.type(0))


def _invoke(context: Any, builder: Any, signature: Signature, address: Any, arguments: Sequence[Any]) -> Any:
    """Call machine code by its address; an exception goes on to the caller."""
    convention, kind, kinds = context.call_conv, signature.return_type, signature.args
    function = builder.bitcast(address, convention.get_function_type(kind, kinds).as_pointer())
    status, result = convention.call_function(builder, function, kind, kinds, arguments)
    with cgutils.if_unlikely(builder, status.is_error):
        convention.return_status_propagate(builder, status)
    return result
