#!/usr/bin/env python3
"""Drags files onto a window as a file manager does: the source's side of XDND (freedesktop.org, drag-and-drop protocol, version 5) over Xlib.

Usage: xdnd_source.py NAME_OF_WINDOW FILE... ; DISPLAY says where. Succeeds once the target says that it has taken the drop."""
import ctypes
import ctypes.util
import pathlib
import select
import sys
import time

PATIENCE = 60  # seconds
VERSION = 5
CLIENT_MESSAGE, SELECTION_REQUEST, SELECTION_NOTIFY = 33, 30, 31
LONG = ctypes.c_long


class ClientMessage(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int), ("display", ctypes.c_void_p),
                ("window", ctypes.c_ulong), ("message_type", ctypes.c_ulong), ("format", ctypes.c_int), ("data", LONG * 5)]


class SelectionRequest(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int), ("display", ctypes.c_void_p),
                ("owner", ctypes.c_ulong), ("requestor", ctypes.c_ulong), ("selection", ctypes.c_ulong), ("target", ctypes.c_ulong),
                ("property", ctypes.c_ulong), ("time", ctypes.c_ulong)]


class Selection(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int), ("display", ctypes.c_void_p),
                ("requestor", ctypes.c_ulong), ("selection", ctypes.c_ulong), ("target", ctypes.c_ulong), ("property", ctypes.c_ulong),
                ("time", ctypes.c_ulong)]


class Event(ctypes.Union):
    _fields_ = [("type", ctypes.c_int), ("message", ClientMessage), ("request", SelectionRequest), ("selection", Selection), ("room", LONG * 24)]


def xlib():
    x = ctypes.CDLL(ctypes.util.find_library("X11") or "libX11.so.6")
    pointer, number = ctypes.c_void_p, ctypes.c_ulong
    for name, result, arguments in [
            ("XOpenDisplay", pointer, [ctypes.c_char_p]), ("XDefaultRootWindow", number, [pointer]),
            ("XInternAtom", number, [pointer, ctypes.c_char_p, ctypes.c_int]),
            ("XCreateSimpleWindow", number, [pointer, number] + [ctypes.c_int] * 2 + [ctypes.c_uint] * 3 + [number] * 2),
            ("XSetSelectionOwner", ctypes.c_int, [pointer, number, number, number]),
            ("XQueryTree", ctypes.c_int, [pointer, number, pointer, pointer, pointer, pointer]),
            ("XFetchName", ctypes.c_int, [pointer, number, pointer]), ("XFree", ctypes.c_int, [pointer]),
            ("XSendEvent", ctypes.c_int, [pointer, number, ctypes.c_int, LONG, pointer]),
            ("XChangeProperty", ctypes.c_int, [pointer, number, number, number, ctypes.c_int, ctypes.c_int, ctypes.c_char_p, ctypes.c_int]),
            ("XTranslateCoordinates", ctypes.c_int, [pointer, number, number] + [ctypes.c_int] * 2 + [pointer] * 3),
            ("XPending", ctypes.c_int, [pointer]), ("XNextEvent", ctypes.c_int, [pointer, pointer]),
            ("XConnectionNumber", ctypes.c_int, [pointer]), ("XFlush", ctypes.c_int, [pointer]), ("XCloseDisplay", ctypes.c_int, [pointer])]:
        function = getattr(x, name)
        function.restype, function.argtypes = result, arguments
    return x


class Source:
    def __init__(self, title, files):
        self.x = xlib()
        self.display = self.x.XOpenDisplay(None)
        if not self.display:
            sys.exit("xdnd_source: no display")
        self.root = self.x.XDefaultRootWindow(self.display)
        self.window = self.x.XCreateSimpleWindow(self.display, self.root, 0, 0, 1, 1, 0, 0, 0)
        self.list = "".join(pathlib.Path(file).resolve().as_uri() + "\r\n" for file in files).encode()
        self.target = self.find(self.root, title.encode())
        if not self.target:
            sys.exit("xdnd_source: no window " + title)

    def atom(self, name):
        return self.x.XInternAtom(self.display, name.encode(), 0)

    def find(self, window, title):
        name = ctypes.c_char_p()
        if self.x.XFetchName(self.display, window, ctypes.byref(name)):
            found = title in name.value
            self.x.XFree(name)
            if found:
                return window
        root, parent, children, count = ctypes.c_ulong(), ctypes.c_ulong(), ctypes.POINTER(ctypes.c_ulong)(), ctypes.c_uint()
        self.x.XQueryTree(self.display, window, ctypes.byref(root), ctypes.byref(parent), ctypes.byref(children), ctypes.byref(count))
        inside = [children[i] for i in range(count.value)]
        if inside:
            self.x.XFree(children)
        return next((hit for hit in (self.find(child, title) for child in inside) if hit), 0)

    def tell(self, kind, *numbers):
        event = Event()
        event.message = ClientMessage(CLIENT_MESSAGE, 0, 1, self.display, self.target, self.atom(kind), 32,
                                      (LONG * 5)(self.window, *numbers))
        self.x.XSendEvent(self.display, self.target, 0, 0, ctypes.byref(event))
        self.x.XFlush(self.display)

    def answer(self, request):
        self.x.XChangeProperty(self.display, request.requestor, request.property, request.target, 8, 0, self.list, len(self.list))
        event = Event()
        event.selection = Selection(SELECTION_NOTIFY, 0, 1, self.display, request.requestor, request.selection, request.target,
                                    request.property, request.time)
        self.x.XSendEvent(self.display, request.requestor, 0, 0, ctypes.byref(event))
        self.x.XFlush(self.display)

    def message(self, kind):
        """The next such message of the target; what it asks for on the way is given."""
        end, event = time.monotonic() + PATIENCE, Event()
        while time.monotonic() < end:
            if not self.x.XPending(self.display):
                select.select([self.x.XConnectionNumber(self.display)], [], [], 0.2)
                continue
            self.x.XNextEvent(self.display, ctypes.byref(event))
            if event.type == SELECTION_REQUEST and event.request.selection == self.atom("XdndSelection"):
                self.answer(event.request)
            elif event.type == CLIENT_MESSAGE and event.message.message_type == self.atom(kind):
                return list(event.message.data)
        sys.exit("xdnd_source: no " + kind)

    def drag(self):
        self.x.XSetSelectionOwner(self.display, self.atom("XdndSelection"), self.window, 0)
        left, top, child = ctypes.c_int(), ctypes.c_int(), ctypes.c_ulong()
        self.x.XTranslateCoordinates(self.display, self.target, self.root, 0, 0, ctypes.byref(left), ctypes.byref(top), ctypes.byref(child))
        self.tell("XdndEnter", VERSION << 24, self.atom("text/uri-list"), 0, 0)
        self.tell("XdndPosition", 0, (left.value + 40) << 16 | (top.value + 40), 0, self.atom("XdndActionCopy"))
        if not self.message("XdndStatus")[1] & 1:
            sys.exit("xdnd_source: the window takes no files")
        self.tell("XdndDrop", 0, 0, 0, 0)
        # The lowest bit should say it; GLFW 3.3 puts the length of the list there.
        if not self.message("XdndFinished")[1]:
            sys.exit("xdnd_source: the drop was refused")
        self.x.XCloseDisplay(self.display)


if __name__ == "__main__":
    Source(sys.argv[1], sys.argv[2:]).drag()
