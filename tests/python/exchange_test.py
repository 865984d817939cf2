"""Arrays of other libraries, with stand-ins for those of a GPU."""
import ctypes
import sys
import types
from unittest import mock

from support import Case, crate_world, main  # first: it skips the test where numpy is missing

import numpy as np
import rubble
from rubble import _exchange

ENGINE = (3, 77)  # device and stream
FLOATS = np.arange(6, dtype=np.float32).reshape(2, 3)


class Interface:
    """An array in "device" memory with ``__cuda_array_interface__``."""

    def __init__(self, **fields):
        self.__cuda_array_interface__ = {"data": (4096, False), "shape": (2, 3), "typestr": "<f4",
                                         "version": 3, **fields}


class Host:
    """An array in host memory with DLPack and nothing else."""

    def __init__(self, array):
        self.array = array

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)


class Tensor:
    """An array in "device" memory with DLPack: a capsule of either layout."""

    def __init__(self, array, device=(2, ENGINE[0]), version=None, code=2):
        self.array, self.device, self.version, self.asked = array, device, version, []
        tensor = _exchange._Tensor(
            data=array.ctypes.data, device_type=device[0], device=device[1], dimensions=array.ndim, code=code,
            bits=8 * array.itemsize, lanes=1, shape=(ctypes.c_int64 * array.ndim)(*array.shape),
            strides=(ctypes.c_int64 * array.ndim)(*(s // array.itemsize for s in array.strides)))
        self.managed = _exchange._VersionedTensor(major=version or 0, tensor=tensor) if version else tensor

    def __dlpack_device__(self):
        return self.device

    def __dlpack__(self, *, stream=None, **options):
        if options and not self.version:
            raise TypeError("an unexpected keyword")
        self.asked.append(stream)
        name = b"dltensor_versioned" if self.version else b"dltensor"
        return _exchange._new_capsule(ctypes.addressof(self.managed), name, None)


def view_of(values, kind=np.float64, device=ENGINE, used=None):
    keep = []
    view = _exchange.view_of("values", values, kind, lambda: device, keep, [] if used is None else used)
    return view, keep


class StreamsOfInterfaces(Case):
    def test_a_stream_is_that_of_the_interface(self):
        for stream, wanted in ((None, 0), (1, 1), (2, 2), (99, 99)):
            view, _ = view_of(Interface(stream=stream))
            self.assertEqual((view.device, view.stream), (1, wanted))
        self.assertInvalid("values.stream", lambda: view_of(Interface(stream=0)))

    def test_without_the_field_it_is_the_legacy_default_stream(self):
        self.assertEqual(view_of(Interface(version=2))[0].stream, 1)

    def test_torch_is_asked_for_its_stream(self):
        # the interface of a tensor has no stream, and its memory is used on the current one
        class TorchTensor(Interface):
            device = "cuda:0"

            def __dlpack__(self, **options):
                raise AssertionError("not needed")
        streams = {"cuda:0": types.SimpleNamespace(cuda_stream=0)}
        torch = types.SimpleNamespace(Tensor=TorchTensor,
                                      cuda=types.SimpleNamespace(current_stream=streams.__getitem__))
        with mock.patch.dict(sys.modules, torch=torch):
            self.assertEqual(view_of(TorchTensor(version=2))[0].stream, 1)
            streams["cuda:0"].cuda_stream = 1234
            self.assertEqual(view_of(TorchTensor(version=2))[0].stream, 1234)

    def test_layouts(self):
        view, _ = view_of(Interface(stream=1))
        self.assertEqual((tuple(view.shape), tuple(view.strides), view.typestr), ((2, 3), (12, 4), b"<f4"))
        view, _ = view_of(Interface(shape=(5,), strides=None, typestr="<i4"))
        self.assertEqual((tuple(view.shape), tuple(view.strides)), ((5, 1), (4, 4)))
        view, _ = view_of(Interface(shape=(5,), strides=(16,)))
        self.assertEqual((tuple(view.shape), tuple(view.strides)), ((5, 1), (16, 4)))
        for shape in ((), (1, 2, 3)):
            self.assertInvalid("values.shape", lambda: view_of(Interface(shape=shape)))
        self.assertInvalid("values", lambda: view_of(Interface(mask=object())))


class Tensors(Case):
    def test_a_capsule_is_asked_for_on_the_stream_of_the_engine(self):
        for version in (None, 1):
            tensor, used = Tensor(FLOATS, version=version), []
            view, _ = view_of(tensor, used=used)
            self.assertEqual(tensor.asked, [ENGINE[1]])
            self.assertEqual((view.data, view.device, view.stream), (FLOATS.ctypes.data, 1, 1))
            layout = tuple(view.shape), tuple(view.strides), view.typestr
            self.assertEqual(layout, ((2, 3), (12, 4), b"<f4"))
            self.assertEqual(len(used), 1)  # it owns the memory until the device has read it

    def test_integers_and_transposed_arrays(self):
        view, _ = view_of(Tensor(np.arange(4, dtype=np.int32), code=0), np.int32)
        self.assertEqual((tuple(view.shape), view.typestr), ((4, 1), b"<i4"))
        view, _ = view_of(Tensor(FLOATS.T))
        self.assertEqual((tuple(view.shape), tuple(view.strides)), ((3, 2), (4, 12)))

    def test_an_interface_with_a_stream_comes_first(self):
        class Both(Interface, Tensor):
            def __init__(self, **fields):
                Tensor.__init__(self, FLOATS)
                Interface.__init__(self, **fields)
        with_stream, without = Both(stream=5), Both(version=2)
        self.assertEqual(view_of(with_stream)[0].stream, 5)
        self.assertEqual(with_stream.asked, [])
        self.assertEqual(view_of(without)[0].data, FLOATS.ctypes.data)
        self.assertEqual(without.asked, [ENGINE[1]])

    def test_what_cannot_be_taken(self):
        self.assertInvalid("values", lambda: view_of(Tensor(FLOATS, device=(2, 0))))
        self.assertInvalid("values", lambda: view_of(Tensor(FLOATS, device=(10, 0))))
        self.assertInvalid("values", lambda: view_of(Tensor(FLOATS, code=4)))
        self.assertInvalid("values", lambda: view_of(Tensor(FLOATS), device=(-1, 0)))
        self.assertRaises(BufferError, lambda: view_of(Tensor(FLOATS, version=2)))
        world = crate_world()
        self.assertInvalid("values", lambda: world.scatter("velocity", [1], Tensor(FLOATS[:1])))
        rows = Interface(shape=(1,), typestr="<i4")
        self.assertInvalid("values", lambda: world.scatter("velocity", rows, Interface(shape=(1, 3))))

    def test_scatter_takes_tensors_of_the_host(self):
        world = crate_world()
        world.scatter("velocity", Host(np.array([1], np.int32)), Host(np.array([[1.0, 2, 3]])))
        self.assertNear(world.velocities[1], (1, 2, 3))
        world.scatter("velocity", memoryview(np.array([1])), memoryview(np.array([[4.0, 5, 6]])))
        self.assertNear(world.velocities[1], (4, 5, 6))

    def test_a_step_lets_go_of_what_it_may_have_read(self):
        world, worlds = crate_world(), rubble.Worlds(threads=1)
        for owner, step in ((world._owner, world.step), (worlds._handle, worlds.step)):
            owner.held.append("values")
            step()
            self.assertEqual(owner.held, [])


class Exports(Case):
    def setUp(self):
        self.asked, self.tensor = [], ctypes.create_string_buffer(128)  # without a deleter

        def device(pointer, number, stream):
            number._obj.value, stream._obj.value = ENGINE
            return 0

        def dlpack_of(pointer, view, stream, tensor):
            self.asked.append(stream)
            tensor._obj.value = ctypes.addressof(self.tensor)
            return 0
        view = rubble._abi.Array(data=4096, shape=(5, 3), strides=(24, 8), typestr=b"<f8", device=1,
                                 stream=ENGINE[1])
        functions = _exchange.Functions(device, dlpack_of)
        self.array = rubble.DeviceArray(types.SimpleNamespace(pointer=None), view, functions)

    def test_a_device_array_says_what_it_is(self):
        array = self.array
        self.assertEqual((array.shape, array.strides, array.ndim, len(array)), ((5, 3), (24, 8), 2, 5))
        self.assertEqual((array.dtype, array.on_device), (np.float64, True))
        self.assertEqual(array.__dlpack_device__(), (2, ENGINE[0]))
        self.assertEqual(array.__cuda_array_interface__["stream"], ENGINE[1])
        self.assertEqual(repr(array), "<rubble.DeviceArray (5, 3) float64 on device>")
        self.assertRaises(TypeError, lambda: np.asarray(array))

    def test_a_tensor_is_for_the_stream_of_its_consumer(self):
        for stream, wanted in ((None, 1), (1, 1), (2, 2), (1234, 1234), (-1, 0)):
            self.array.__dlpack__(stream=stream, max_version=(1, 0), dl_device=(2, ENGINE[0]), copy=False)
            self.assertEqual(self.asked.pop(), wanted)
        for options in ({"stream": 0}, {"copy": True}, {"dl_device": (1, 0)}):
            self.assertRaises(BufferError, lambda: self.array.__dlpack__(**options))
        self.assertEqual(self.asked, [])

    def test_an_array_of_the_host_has_no_stream(self):
        array = crate_world().array("position")
        self.assertRaises(BufferError, lambda: array.__dlpack__(stream=1))
        self.assertEqual(np.from_dlpack(array).shape, array.shape)
        self.assertEqual(array.__array__().shape, array.shape)


if __name__ == "__main__":
    main()
