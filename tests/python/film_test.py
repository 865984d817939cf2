"""Films, pictures in notebooks, and progress of long calls."""
import contextlib
import io
import os
import shutil
import signal
import struct
import tempfile
import threading
import unittest
import zlib

from support import Case, crate_scene, crate_world, main  # first: it skips the test where numpy is missing

import _thread
import numpy as np
import rubble
from rubble import _film

OPENGL = rubble.info()["opengl"].startswith("on")
SMALL = {"width": 64, "height": 48, "samples": 1}


class Terminal(io.StringIO):
    encoding = "utf-8"

    def isatty(self):
        return True


def chunks(data):
    """Kind and content of each part of a PNG, with its checksum tested."""
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    at = 8
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        content = data[at + 8:at + 8 + size]
        assert struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0] == zlib.crc32(kind + content)
        yield kind, content
        at += 12 + size


def pictures_of(data):
    """Pictures of a PNG whose rows are differences from those above."""
    parts = list(chunks(data))
    width, height = struct.unpack(">II", parts[0][1][:8])
    for kind, content in parts:
        if kind in (b"IDAT", b"fdAT"):
            rows = np.frombuffer(zlib.decompress(content[4:] if kind == b"fdAT" else content), np.uint8)
            rows = rows.reshape(height, -1)
            assert (rows[:, 0] == 2).all()
            yield np.cumsum(rows[:, 1:], axis=0, dtype=np.uint8).reshape(height, width, 3)


class Progress(Case):
    def test_a_function_is_told_what_is_done_and_what_is_left(self):
        worlds = rubble.Worlds(crate_scene(), 3, threads=1)
        run = rubble.Run(crate_scene(), threads=1)
        for call in (crate_world().step, worlds.step, run.run):
            seen = []
            call(5, progress=lambda *told: seen.append(told))
            self.assertEqual([each[:2] for each in seen], [(k, 5) for k in range(1, 6)])
            self.assertEqual(seen[-1][2], 0)
            self.assertGreater(seen[0][2], 0)

    def test_steps_are_the_same_with_it(self):
        plain, told = crate_world(), crate_world()
        plain.step(30)
        self.assertEqual(told.step(30, progress=lambda *_: None).step, 29)
        self.assertEqual(plain.hash(), told.hash())

    def test_a_log_has_a_line_every_tenth_with_the_time_left(self):
        with contextlib.redirect_stderr(io.StringIO()) as log:
            crate_world().step(50, progress=True)
        lines = log.getvalue().splitlines()
        self.assertEqual(len(lines), 10)
        self.assertRegex(lines[0], r"^world: step 5/50, [\d.]+ ms/step, 0 s, \d+ s left$")

    def test_a_terminal_has_a_bar(self):
        with contextlib.redirect_stderr(Terminal()) as screen:
            rubble.Worlds(crate_scene(), 3, threads=1).step(4, progress=True)
        self.assertTrue(screen.getvalue().startswith("\r3 worlds ") or "\r3 worlds " in screen.getvalue())
        self.assertIn("█" * 30 + " step 4/4", screen.getvalue())
        self.assertTrue(screen.getvalue().endswith("\n"))

    def test_without_it_nothing_is_shown(self):
        with contextlib.redirect_stderr(io.StringIO()) as log:
            crate_world().step(20)
            rubble.Worlds(crate_scene(), 2, threads=1).step(20, progress=False)
        self.assertEqual(log.getvalue(), "")

    def test_ctrl_c_ends_it_between_two_steps_and_closes_the_bar(self):
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        self.addCleanup(signal.signal, signal.SIGINT, before)
        world, worlds = crate_world(), rubble.Worlds(crate_scene(), 3, threads=1)
        run = rubble.Run(crate_scene(), threads=1)
        for call, owner in ((world.step, world), (worlds.step, worlds[0]), (run.run, run.world)):
            for progress in (None, True):
                timer = threading.Timer(0.3, _thread.interrupt_main)
                with contextlib.redirect_stderr(Terminal()) as screen:
                    timer.start()
                    with self.assertRaises(KeyboardInterrupt):
                        call(10 ** 8, progress=progress)
                    timer.join()
                self.assertEqual(screen.getvalue()[-1:], "\n" if progress else "")
                taken = owner.step_count
                owner.step()
                self.assertEqual(owner.step_count, taken + 1)


class Pngs(Case):
    def test_pictures_are_read_as_they_were(self):
        random = np.random.default_rng(0)
        given = [random.integers(0, 256, (7, 5, 3), np.uint8) for _ in range(3)]
        for count in (1, 3):
            data = _film.png_of(given[:count], 25)
            read = list(pictures_of(data))
            self.assertEqual(len(read), count)
            for one, other in zip(given, read):
                np.testing.assert_array_equal(one, other)
        kinds = [kind for kind, _ in chunks(data)]
        frames = [b"fcTL", b"IDAT", b"fcTL", b"fdAT", b"fcTL", b"fdAT"]
        self.assertEqual(kinds, [b"IHDR", b"acTL", *frames, b"IEND"])
        control = [content for kind, content in chunks(data) if kind == b"fcTL"]
        self.assertEqual([struct.unpack(">IIIIIHH", each[:24])[5:] for each in control], 3 * [(40, 1000)])

    def test_a_notebook_shows_the_text_where_no_picture_can_be_drawn(self):
        def fails():
            raise rubble.Error("no OpenGL")
        self.assertIsNone(_film.in_notebook(fails))


class Films(Case):
    def test_what_cannot_be_written_is_refused_before_the_first_step(self):
        world = crate_world()
        self.assertInvalid("file", lambda: world.film("film.avi"))
        self.assertInvalid("fps", lambda: world.film("film.png", fps=0))
        self.assertInvalid("slow", lambda: world.film("film.png", slow=-1))
        if shutil.which("ffmpeg"):
            self.assertInvalid("size", lambda: world.film("film.mp4", width=321))
        path, os.environ["PATH"] = os.environ["PATH"], ""
        try:
            self.assertIn("ffmpeg", self.assertInvalid("file", lambda: world.film("film.mp4")).expected)
        finally:
            os.environ["PATH"] = path
        self.assertEqual(world.step_count, 0)

    def test_the_camera_shows_all_that_moves_from_the_first_frame_to_the_last(self):
        world = crate_world()
        world.bodies["crate"].velocity = (6, 0, 4)
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "out.rubble")
            with rubble.Recorder(world, file) as out:
                for _ in range(60):
                    world.step()
                    out.write()
            recording = rubble.Recording(file)
            camera = _film._camera(recording, range(60), np.full((2, 3), 0.9), 0.6, 16 / 9)
            view = camera["target"] - camera["eye"]
            for frame in recording:
                way = frame.positions[1] - camera["eye"]
                angle = np.arccos(way @ view / np.linalg.norm(way) / np.linalg.norm(view))
                self.assertLess(angle, 0.3)
            self.assertGreater(camera["eye"][2], camera["target"][2])

    @unittest.skipUnless(OPENGL, "no OpenGL in this build or on this machine")
    def test_a_world_is_filmed_while_it_steps(self):
        world = crate_world()
        seen = []
        film = world.film(None, 0.2, fps=20, progress=lambda *told: seen.append(told[:2]), **SMALL)
        self.assertEqual((film.width, film.height, film.frames, film.fps), (64, 48, 4, 20))
        self.assertEqual(world.step_count, 9)
        self.assertEqual(seen, [(k, 9) for k in range(1, 10)] + [(k, 4) for k in range(1, 5)])
        self.assertRegex(repr(film), r"^<rubble.Film 64x48, 0\.2 s, \d+ bytes>$")
        shown = film._repr_html_()
        self.assertIn(f"data:{film.type};base64,", shown)
        self.assertTrue(shown.startswith("<video" if shutil.which("ffmpeg") else "<img"))

    @unittest.skipUnless(OPENGL, "no OpenGL in this build or on this machine")
    def test_a_film_is_a_file_of_its_kind(self):
        heads = {".png": b"\x89PNG", ".gif": b"GIF8", ".webm": b"\x1a\x45\xdf\xa3", ".mp4": b"ftyp"}
        world = crate_world()
        with tempfile.TemporaryDirectory() as folder:
            for suffix, head in heads.items():
                if suffix != ".png" and not shutil.which("ffmpeg"):
                    continue
                file = os.path.join(folder, "film" + suffix)
                film = world.film(file, 0.1, fps=20, **SMALL)
                with open(file, "rb") as stream:
                    self.assertEqual(stream.read(), film.data)
                self.assertIn(head, film.data[:12])
                self.assertInvalid("file", lambda: film.save(os.path.join(folder, "film.txt")))
            with rubble.Recorder(world, os.path.join(folder, "out.rubble")) as out:
                for _ in range(12):
                    out.write()
                    world.step()
            recording = rubble.Recording(os.path.join(folder, "out.rubble"))
            view = {"eye": (4, -4, 3), "target": (0, 0, 1), **SMALL}
            film = recording.film(os.path.join(folder, "out.png"), fps=20, **view)
            self.assertEqual(film.frames, 4)
            first, *_, last = pictures_of(film.data)
            np.testing.assert_array_equal(first, recording.render(0, **view))
            self.assertFalse(np.array_equal(first, last))
            self.assertTrue(_film.png_of([recording.render(-1, width=32, height=32)]).startswith(b"\x89PNG"))

    @unittest.skipUnless(OPENGL, "no OpenGL in this build or on this machine")
    def test_a_notebook_shows_worlds_and_scenes(self):
        _film.NOTEBOOK.update(SMALL)
        self.addCleanup(_film.NOTEBOOK.pop, "samples")
        self.addCleanup(_film.NOTEBOOK.update, width=640, height=360)
        for shown in (crate_world(), crate_scene()):
            picture, = pictures_of(shown._repr_png_())
            self.assertEqual(picture.shape, (48, 64, 3))
            self.assertGreater(picture.std(), 5)
        picture, = pictures_of(rubble.Worlds(crate_scene(), 3, threads=1)._repr_png_())
        self.assertEqual(picture.shape, (240, 3 * 320, 3))
        self.assertIsNone(rubble.Worlds()._repr_png_())

    @unittest.skipUnless(OPENGL, "no OpenGL in this build or on this machine")
    def test_worlds_and_sizes_by_turns_have_the_pictures_that_they_have_alone(self):
        one, other = crate_world(), rubble.World(crate_scene(position=(0, 0, 4)), threads=1)
        first = one.render(**SMALL)
        second = other.render(**SMALL)
        self.assertEqual(one.render(32, 32, samples=1).shape, (32, 32, 3))
        self.assertFalse(np.array_equal(first, second))
        np.testing.assert_array_equal(one.render(**SMALL), first)
        np.testing.assert_array_equal(other.render(**SMALL), second)


if __name__ == "__main__":
    main()
