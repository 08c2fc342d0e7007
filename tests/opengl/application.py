#!/usr/bin/env python3
"""Draws one frame with OpenGL: three objects, two textures, fixed seed. It is the application behind `frame.*.json`.

Needs the Python packages moderngl and numpy, and an X server. `tests/opengl/renew` captures it.
"""
import moderngl
import numpy

SIZE = (120, 90)
TEXELS = 32
VERTEX = """
#version 330
uniform mat4 projection;
uniform mat4 view;
uniform mat4 model;
in vec3 position;
in vec3 normal;
in vec2 uv;
in vec4 tangent;
out vec3 to_normal;
out vec3 to_tangent;
out float handedness;
out vec2 at;
void main() {
    mat3 turned = mat3(model);
    to_normal = turned * normal;
    to_tangent = turned * tangent.xyz;
    handedness = tangent.w;
    at = uv;
    vec4 world = model * vec4(position, 1.0);
    gl_Position = projection * view * world;
}
"""
FRAGMENT = """
#version 330
uniform sampler2D albedo;
uniform sampler2D normal_map;
uniform vec3 base_color;
uniform vec3 light_direction;
uniform vec3 viewer;
uniform float ambient;
uniform float diffuse;
uniform float specular;
uniform float shininess;
uniform bool bumpy;
in vec3 to_normal;
in vec3 to_tangent;
in float handedness;
in vec2 at;
out vec4 color;
void main() {
    vec3 n = vec3(0.0, 0.0, 1.0);
    if (bumpy) n = texture(normal_map, at).xyz * 2.0 - 1.0;
    n = normalize(to_tangent * n.x + cross(to_normal, to_tangent) * handedness * n.y + to_normal * n.z);
    vec3 l = normalize(light_direction);
    vec3 h = normalize(l + normalize(viewer));
    vec3 base = base_color * texture(albedo, at).rgb;
    float light = ambient + diffuse * max(dot(n, l), 0.0) + specular * pow(max(dot(n, h), 0.0), shininess);
    color = vec4(base * light, 1.0);
}
"""


def frustum(field, aspect, near, far):
    s = 1 / numpy.tan(numpy.radians(field) / 2)
    a, b = (far + near) / (near - far), 2 * far * near / (near - far)
    return numpy.array([[s / aspect, 0, 0, 0], [0, s, 0, 0], [0, 0, a, b], [0, 0, -1, 0]])


def looking_at(eye, target):
    back = numpy.array(eye, float) - target
    back /= numpy.linalg.norm(back)
    right = numpy.cross([0, 1, 0], back)
    right /= numpy.linalg.norm(right)
    turn = numpy.array([right, numpy.cross(back, right), back])
    return numpy.vstack([numpy.column_stack([turn, -turn @ eye]), [0, 0, 0, 1]]), back


def placed(x, y, z):
    matrix = numpy.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def sphere(columns, rows):
    """Returns vertices (position, normal, uv, tangent) and indices of triangles."""
    vertices, indices = [], []
    for row in range(rows + 1):
        for column in range(columns + 1):
            a, b = 2 * numpy.pi * column / columns, numpy.pi * row / rows
            n = numpy.sin(b) * numpy.sin(a), -numpy.cos(b), numpy.sin(b) * numpy.cos(a)
            vertices.append([*n, *n, 2 * column / columns, row / rows, numpy.cos(a), 0, -numpy.sin(a), 1])
    for row in range(rows):
        for column in range(columns):
            k = row * (columns + 1) + column
            indices += [k, k + 1, k + columns + 2, k, k + columns + 2, k + columns + 1]
    return vertices, indices


def floor(half):
    """Returns a square as a strip."""
    corner = lambda x, z: [x * half, 0, z * half, 0, 1, 0, 2 * x, -2 * z, 1, 0, 0, 1]
    return [corner(-1, -1), corner(-1, 1), corner(1, -1), corner(1, 1)]


def cone(sides):
    """Returns a cone without a bottom as a fan around its tip."""
    rim = [(numpy.sin(a), numpy.cos(a)) for a in 2 * numpy.pi * numpy.arange(sides + 1) / sides]
    s = numpy.sqrt(0.5)
    return [[0, 1, 0, 0, 1, 0, 0.5, 0.5, 1, 0, 0, 1]] + [[x, 0, z, x * s, s, z * s, 0.5, 0.5, z, 0, -x, 1] for x, z in rim]


def colors(random):
    checks = (numpy.indices((TEXELS, TEXELS)) // 8).sum(axis=0) % 2
    picture = numpy.where(checks[..., None] == 0, [230, 220, 200], [90, 110, 160])
    return (picture + random.integers(-8, 9, (TEXELS, TEXELS, 3))).astype("u1")


def bumps():
    y, x = numpy.indices((TEXELS, TEXELS)) * (2 * numpy.pi / TEXELS)
    normals = numpy.stack([0.5 * numpy.sin(2 * x), 0.5 * numpy.sin(2 * y), numpy.ones_like(x)], axis=2)
    normals /= numpy.linalg.norm(normals, axis=2, keepdims=True)
    return numpy.round(127.5 * (normals + 1)).astype("u1")


def main():
    context = moderngl.create_standalone_context()
    program = context.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
    for unit, (name, picture) in enumerate([("albedo", colors(numpy.random.default_rng(2026))), ("normal_map", bumps())]):
        texture = context.texture((TEXELS, TEXELS), 3, picture.tobytes())
        texture.build_mipmaps()
        texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
        texture.use(unit)
        program[name] = unit
    frame = context.framebuffer([context.renderbuffer(SIZE)], context.depth_renderbuffer(SIZE))
    frame.use()
    context.enable(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
    frame.clear(0.0, 0.0, 0.0, 1.0)
    view, viewer = looking_at((1.5, 2.5, 5.0), (0.0, 0.4, 0.0))
    fixed = {"projection": frustum(40, SIZE[0] / SIZE[1], 1, 20).T.ravel(), "view": view.T.ravel(), "viewer": viewer,
             "light_direction": (0.6, 1.0, 0.4), "ambient": 0.15, "diffuse": 0.7, "specular": 0.3, "shininess": 24.0}
    for name, value in fixed.items():
        program[name] = tuple(value) if numpy.iterable(value) else value
    ball, indices = sphere(20, 12)
    for vertices, indices, mode, model, color, bumpy in [
        (floor(2.0), None, moderngl.TRIANGLE_STRIP, placed(0, -0.6, 0), (1.0, 1.0, 1.0), False),
        (ball, indices, moderngl.TRIANGLES, placed(-0.7, 0.4, 0), (1.0, 0.9, 0.8), True),
        (cone(24), None, moderngl.TRIANGLE_FAN, placed(1.1, -0.6, 0.6), (0.9, 0.4, 0.3), False),
    ]:
        program["model"], program["base_color"], program["bumpy"] = tuple(model.T.ravel()), color, bumpy
        buffer = context.buffer(numpy.array(vertices, "f4").tobytes())
        index = None if indices is None else context.buffer(numpy.array(indices, "u4").tobytes())
        context.vertex_array(program, buffer, "position", "normal", "uv", "tangent", index_buffer=index).render(mode)
    context.finish()
    return frame.read()


if __name__ == "__main__":
    main()
