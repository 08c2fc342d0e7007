#!/usr/bin/env python3
"""Draws one frame with the fixed function of OpenGL: immediate mode, client arrays and a display list. `tests/opengl/check` captures it.

Needs an X server, and no packages: Xlib and OpenGL are called as C libraries.
"""
import ctypes
import math

WIDTH, HEIGHT, TEXELS = 200, 150, 16
X = ctypes.CDLL("libX11.so.6")
GL = ctypes.CDLL("libGL.so.1")
for function in X.XOpenDisplay, X.XCreateSimpleWindow, GL.glXChooseVisual, GL.glXCreateContext:
    function.restype = ctypes.c_void_p

DEPTH_TEST, CULL_FACE, LIGHTING, LIGHT0, TEXTURE_2D = 0x0B71, 0x0B44, 0x0B50, 0x4000, 0x0DE1
TRIANGLES, TRIANGLE_FAN, QUADS, QUAD_STRIP = 4, 6, 7, 8
PROJECTION, MODELVIEW, FLAT, SMOOTH = 0x1701, 0x1700, 0x1D00, 0x1D01
FRONT, AMBIENT, DIFFUSE, SPECULAR, POSITION, SHININESS, AMBIENT_AND_DIFFUSE = 0x0404, 0x1200, 0x1201, 0x1202, 0x1203, 0x1601, 0x1602
VERTEX_ARRAY, NORMAL_ARRAY, FLOAT, UNSIGNED_SHORT, UNSIGNED_BYTE = 0x8074, 0x8075, 0x1406, 0x1403, 0x1401


def floats(*numbers):
    return (ctypes.c_float * len(numbers))(*numbers)


def single(number):
    return ctypes.c_float(number)


def double(number):
    return ctypes.c_double(number)


def window():
    display = ctypes.c_void_p(X.XOpenDisplay(None))
    # RGBA, double buffer, 24 bits of depth.
    visual = ctypes.c_void_p(GL.glXChooseVisual(display, 0, (ctypes.c_int * 5)(4, 5, 12, 24, 0)))
    root = ctypes.c_ulong(X.XDefaultRootWindow(display))
    drawable = ctypes.c_ulong(X.XCreateSimpleWindow(display, root, 0, 0, WIDTH, HEIGHT, 0, 0, 0))
    X.XMapWindow(display, drawable)
    context = ctypes.c_void_p(GL.glXCreateContext(display, visual, None, 1))
    GL.glXMakeCurrent(display, drawable, context)
    return display, drawable


def texture():
    texels = bytes(255 if (x // 4 + y // 4) % 2 == channel % 2 else 60 for y in range(TEXELS) for x in range(TEXELS) for channel in range(3))
    GL.glTexParameteri(TEXTURE_2D, 0x2801, 0x2601)  # linear filter
    GL.glTexImage2D(TEXTURE_2D, 0, 0x1907, TEXELS, TEXELS, 0, 0x1907, UNSIGNED_BYTE, texels)


def material(red, green, blue, specular):
    GL.glMaterialfv(FRONT, AMBIENT_AND_DIFFUSE, floats(red, green, blue, 1))
    GL.glMaterialfv(FRONT, SPECULAR, floats(specular * red, specular * green, specular * blue, 1))
    GL.glMaterialf(FRONT, SHININESS, single(20))


def floor():
    """Draws a textured square in immediate mode."""
    GL.glEnable(TEXTURE_2D)
    GL.glBegin(QUADS)
    GL.glNormal3f(single(0), single(1), single(0))
    for x, z in (-2, -2), (-2, 2), (2, 2), (2, -2):
        GL.glTexCoord2f(single(x), single(z))
        GL.glVertex3f(single(x), single(0), single(z))
    GL.glEnd()
    GL.glDisable(TEXTURE_2D)


def ball(columns, rows):
    """Draws a ball from arrays and indices in memory of the application."""
    vertices, indices = [], []
    for row in range(rows + 1):
        for column in range(columns + 1):
            a, b = 2 * math.pi * column / columns, math.pi * row / rows
            vertices += [math.sin(b) * math.sin(a), -math.cos(b), math.sin(b) * math.cos(a)]
    for row in range(rows):
        for column in range(columns):
            k = row * (columns + 1) + column
            indices += [k, k + 1, k + columns + 2, k, k + columns + 2, k + columns + 1]
    array, numbers = floats(*vertices), (ctypes.c_uint16 * len(indices))(*indices)
    for kind in VERTEX_ARRAY, NORMAL_ARRAY:
        GL.glEnableClientState(kind)
    GL.glVertexPointer(3, FLOAT, 0, array)
    GL.glNormalPointer(FLOAT, 12, array)
    GL.glDrawElements(TRIANGLES, len(indices), UNSIGNED_SHORT, numbers)


def tower(sides):
    """Compiles a flat tower with a smooth roof."""
    around = [(math.sin(a), math.cos(a)) for a in (2 * math.pi * side / sides for side in range(sides + 1))]
    GL.glNewList(1, 0x1300)
    GL.glShadeModel(FLAT)
    GL.glBegin(QUAD_STRIP)
    for x, z in around:
        GL.glNormal3f(single(x), single(0), single(z))
        GL.glVertex3fv(floats(x, 1, z))
        GL.glVertex3fv(floats(x, 0, z))
    GL.glEnd()
    GL.glShadeModel(SMOOTH)
    GL.glBegin(TRIANGLE_FAN)
    GL.glNormal3f(single(0), single(1), single(0))
    GL.glVertex3d(double(0), double(2), double(0))
    for x, z in around:
        GL.glNormal3f(single(0.7 * x), single(0.7), single(0.7 * z))
        GL.glVertex3f(single(x), single(1), single(z))
    GL.glEnd()
    GL.glEndList()


def frame():
    """Draws all objects."""
    GL.glLoadIdentity()
    GL.glLightfv(LIGHT0, POSITION, floats(0.5, 1, 0.8, 0))
    GL.glTranslatef(single(0), single(-0.6), single(-7))
    GL.glRotatef(single(25), single(1), single(0), single(0))
    GL.glClear(0x4100)
    material(0.8, 0.8, 0.8, 0)
    floor()
    GL.glPushMatrix()
    GL.glTranslatef(single(-0.8), single(1), single(0))
    material(0.9, 0.5, 0.3, 0.5)
    ball(24, 16)
    GL.glPopMatrix()
    GL.glTranslatef(single(1.2), single(0), single(0.6))
    GL.glScalef(single(0.6), single(0.6), single(0.6))
    material(0.4, 0.6, 0.9, 0)
    GL.glCallList(1)


def main():
    display, drawable = window()
    texture()
    tower(8)
    # The last state makes normals unit vectors.
    for state in DEPTH_TEST, CULL_FACE, LIGHTING, LIGHT0, 0x0BA1:
        GL.glEnable(state)
    GL.glViewport(0, 0, WIDTH, HEIGHT)
    GL.glMatrixMode(PROJECTION)
    GL.glFrustum(*map(double, (-0.4, 0.4, -0.3, 0.3, 1, 20)))
    GL.glMatrixMode(MODELVIEW)
    # apitrace replays the first frame in a window of another size.
    for _ in range(2):
        frame()
        GL.glXSwapBuffers(display, drawable)


if __name__ == "__main__":
    main()
