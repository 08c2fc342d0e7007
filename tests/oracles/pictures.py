#!/usr/bin/env python3
"""pictures.py - independent picture oracle: glTF 2.0 / OBJ -> Mesa (llvmpipe or softpipe, headless EGL) -> PNG (+ raw pixels with coverage).

  pictures.py MODEL OUT.png [--mode bump|phong|gouraud|flat|tex] [--filter nearest|bilinear|trilinear]
     [--viewproj CAM.json|16 numbers, row-major, clip = M*[x y z 1]]      default: auto camera, written to OUT.cam.json
     [--L x y z] [--V x y z]   directions TO the light / TO the viewer at infinity, in WORLD space (default V = from auto cam)
     [--ka .1] [--kd .8] [--ks .4] [--n 32] [--size W H] [--gate] [--unlit-base] [--srgb] [--cull (back faces of materials that are not doubleSided)]
     [--tangent file|vertex] [--raw OUT.raw] [--az deg --el deg]
Colour:  C = base*(ka + kd*max(N.L,0)) + ks*max(N.H,0)^n,  H = normalize(L+V) ; --gate: specular 0 when N.L<=0 (GL fixed function).
base = baseColorFactor * baseColorTexture, texels used as stored unless --srgb (then decoded before filtering by the GL sampler).
gouraud: C's lighting part at vertices, interpolated perspective-correctly, then modulated by the texture (separate specular added after).
flat: geometric face normal, one colour per face (times texture).  bump: N = normalize(T*nx + B*ny + Nv*nz), B = cross(Nv,T)*w.
N,T are interpolated unnormalised, then the sum is normalised (what MikkTSpace asks for).
--raw saves four bytes per pixel without a head: red, green, blue, and 1 where a triangle covers the pixel; row 0 = TOP of picture.
Environment: GALLIUM_DRIVER=llvmpipe|softpipe picks the rasteriser; GALLIVM_PERF=no_brilinear,no_rho_approx,no_quad_lod,no_aos_sampling
turns off llvmpipe's mip/filter short cuts (set by default here unless already set)."""
import os, sys, json, argparse, base64, io
os.environ.setdefault('GALLIVM_PERF', 'no_brilinear,no_rho_approx,no_quad_lod,no_aos_sampling')
os.environ.setdefault('LIBGL_ALWAYS_SOFTWARE', '1')
import numpy as np
from PIL import Image
Image.MAX_IMAGE_PIXELS = None

CT = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
NC = {'SCALAR': 1, 'VEC2': 2, 'VEC3': 3, 'VEC4': 4, 'MAT4': 16}

def node_matrix(n):
    if n.matrix: return np.array(n.matrix, np.float64).reshape(4, 4).T
    M = np.eye(4)
    if n.scale: M = np.diag(list(n.scale) + [1.0])
    if n.rotation:
        x, y, z, w = n.rotation
        R = np.eye(4)
        R[:3, :3] = [[1-2*(y*y+z*z), 2*(x*y-z*w), 2*(x*z+y*w)], [2*(x*y+z*w), 1-2*(x*x+z*z), 2*(y*z-x*w)], [2*(x*z-y*w), 2*(y*z+x*w), 1-2*(x*x+y*y)]]
        M = R @ M
    if n.translation:
        T = np.eye(4); T[:3, 3] = n.translation; M = T @ M
    return M

def load_gltf(path):
    import pygltflib
    g = pygltflib.GLTF2().load(path); d = os.path.dirname(os.path.abspath(path)); bufs = {}
    def buf(i):
        if i not in bufs:
            u = g.buffers[i].uri
            if u is None: bufs[i] = g.binary_blob()
            elif u.startswith('data:'): bufs[i] = base64.b64decode(u.split(',', 1)[1])
            else: bufs[i] = open(os.path.join(d, u), 'rb').read()
        return bufs[i]
    def acc(i):
        a = g.accessors[i]; dt = np.dtype(CT[a.componentType]); nc = NC[a.type]
        if a.bufferView is None: return np.zeros((a.count, nc), np.float32)
        v = g.bufferViews[a.bufferView]; off = (v.byteOffset or 0) + (a.byteOffset or 0); st = v.byteStride or dt.itemsize*nc
        raw = np.frombuffer(buf(v.buffer), np.uint8)
        idx = off + np.arange(a.count)[:, None]*st + np.arange(dt.itemsize*nc)[None, :]
        r = raw[idx].copy().view(dt).reshape(a.count, nc)
        if a.normalized: r = np.maximum(r.astype(np.float32)/np.iinfo(dt).max, -1)
        return r
    def image(ti):
        if ti is None: return None
        t = g.textures[ti.index]; im = g.images[t.source]
        if im.bufferView is not None:
            v = g.bufferViews[im.bufferView]; o = v.byteOffset or 0; b = buf(v.buffer)[o:o+v.byteLength]
        elif im.uri.startswith('data:'): b = base64.b64decode(im.uri.split(',', 1)[1])
        else: b = open(os.path.join(d, im.uri), 'rb').read()
        s = g.samplers[t.sampler] if t.sampler is not None else None
        return np.asarray(Image.open(io.BytesIO(b)).convert('RGBA')), ((s.wrapS or 10497, s.wrapT or 10497) if s else (10497, 10497)), (ti.texCoord or 0)
    out = []
    def walk(ni, P):
        n = g.nodes[ni]; M = P @ node_matrix(n)
        if n.mesh is not None:
            for p in g.meshes[n.mesh].primitives:
                if p.mode not in (None, 4): print('skip primitive mode', p.mode, file=sys.stderr); continue
                a = p.attributes; pos = acc(a.POSITION).astype(np.float64); nv = len(pos)
                idx = acc(p.indices).reshape(-1).astype(np.int64) if p.indices is not None else np.arange(nv)
                m = g.materials[p.material] if p.material is not None else None
                pbr = m.pbrMetallicRoughness if m else None
                f = np.array((pbr.baseColorFactor if pbr and pbr.baseColorFactor else [1, 1, 1, 1]), np.float32)
                base = image(pbr.baseColorTexture) if pbr else None
                nt = m.normalTexture if m else None
                N3 = np.linalg.inv(M[:3, :3]).T
                nrm = acc(a.NORMAL).astype(np.float64) @ N3.T if a.NORMAL is not None else None
                tan = None
                if a.TANGENT is not None:
                    t = acc(a.TANGENT).astype(np.float64); tan = np.concatenate([t[:, :3] @ M[:3, :3].T, t[:, 3:]], 1)
                    tan[:, :3] /= np.maximum(np.linalg.norm(tan[:, :3], axis=1, keepdims=True), 1e-30)
                if nrm is not None: nrm /= np.maximum(np.linalg.norm(nrm, axis=1, keepdims=True), 1e-30)
                out.append(dict(pos=(np.c_[pos, np.ones(nv)] @ M.T)[:, :3], nrm=nrm, tan=tan, idx=idx, factor=f, base=base,
                    uv=acc(a.TEXCOORD_0).astype(np.float64) if a.TEXCOORD_0 is not None else np.zeros((nv, 2)),
                    nmap=image(nt), nscale=(nt.scale if nt is not None and nt.scale is not None else 1.0), ds=bool(m and m.doubleSided), det=np.linalg.det(M[:3, :3])))
        for c in n.children or []: walk(c, M)
    for r in g.scenes[g.scene or 0].nodes: walk(r, np.eye(4))
    return out

def load_any(path):
    if path.lower().endswith(('.gltf', '.glb')): return load_gltf(path)
    import trimesh
    m = trimesh.load(path, force='mesh', process=False)
    uv = getattr(m.visual, 'uv', None)
    return [dict(pos=np.asarray(m.vertices, np.float64), nrm=np.asarray(m.vertex_normals, np.float64), tan=None, idx=np.asarray(m.faces).reshape(-1),
        uv=np.asarray(uv, np.float64) if uv is not None else np.zeros((len(m.vertices), 2)), factor=np.ones(4, np.float32), base=None, nmap=None, nscale=1.0, ds=True, det=1.0)]

def auto_cam(prims, W, H, az=30., el=20., fov=35.):
    P = np.concatenate([p['pos'] for p in prims]); lo, hi = P.min(0), P.max(0); c = (lo+hi)/2; r = np.linalg.norm(hi-lo)/2
    a, e = np.radians([az, el]); v = np.array([np.sin(a)*np.cos(e), np.sin(e), np.cos(a)*np.cos(e)])
    dist = r/np.sin(np.radians(fov)/2)*1.02; eye = c+v*dist
    z = v; x = np.cross([0, 1, 0], z); x /= np.linalg.norm(x); y = np.cross(z, x)
    Vw = np.eye(4); Vw[:3, :3] = [x, y, z]; Vw[:3, 3] = -Vw[:3, :3] @ eye
    n, f = dist-r*1.05, dist+r*1.05; n = max(n, dist*0.01); s = 1/np.tan(np.radians(fov)/2); asp = W/H
    Pm = np.array([[s/asp, 0, 0, 0], [0, s, 0, 0], [0, 0, (f+n)/(n-f), 2*f*n/(n-f)], [0, 0, -1, 0]])
    return Pm @ Vw, v

LIGHT = '''
uniform vec3 L, V; uniform vec4 K; uniform int gate;   // K = ka kd ks n
vec2 shade(vec3 N){ float d=dot(N,L); vec3 H=normalize(L+V); float s=pow(max(dot(N,H),0.0),K.w);
  if(gate==1 && d<=0.0) s=0.0; return vec2(K.x+K.y*max(d,0.0), K.z*s); }
'''
VS = '''#version 330
in vec3 pos, nrm, fnrm; in vec2 uv; in vec4 tan;
uniform mat4 M; uniform int mode;
out vec3 vN; out vec4 vT; out vec2 vUV; out vec2 vC; flat out vec2 fC;
''' + LIGHT + '''
void main(){ gl_Position=M*vec4(pos,1); vN=nrm; vT=tan; vUV=uv; vC=shade(normalize(nrm)); fC=shade(normalize(fnrm)); }
'''
FS = '''#version 330
in vec3 vN; in vec4 vT; in vec2 vUV; in vec2 vC; flat in vec2 fC;
uniform sampler2D base, nmap; uniform vec4 factor; uniform int mode, hasBase, hasN; uniform float nscale;
layout(location=0) out vec4 oC; layout(location=1) out float oCovered;
''' + LIGHT + '''
void main(){
  vec4 b=factor; if(hasBase==1) b*=texture(base,vUV);
  vec3 N=normalize(vN); vec2 c;
  if(mode==0 && hasN==1){                                   // bump
    vec3 t=texture(nmap,vUV).xyz*2.0-1.0; t.xy*=nscale; vec3 T,B;
    T=vT.xyz; B=cross(vN,T)*vT.w; N=normalize(T*t.x+B*t.y+vN*t.z);
  }
  if(mode==2) c=vC; else if(mode==3) c=fC; else c=shade(N);
  if(mode==4) oC=b; else oC=vec4(b.rgb*c.x+c.y,b.a);
  oCovered=1.0;
}
'''

def vertex_tangents(p):
    """Lengyel per-vertex tangents (NOT MikkTSpace): used only when the file has none. For MikkTSpace run
    `gltf-transform tangents in out` first, which writes a TANGENT attribute."""
    i = p['idx'].reshape(-1, 3); P, U = p['pos'], p['uv']; e1, e2 = P[i[:, 1]]-P[i[:, 0]], P[i[:, 2]]-P[i[:, 0]]
    d1, d2 = U[i[:, 1]]-U[i[:, 0]], U[i[:, 2]]-U[i[:, 0]]; det = d1[:, 0]*d2[:, 1]-d2[:, 0]*d1[:, 1]; r = np.where(np.abs(det) < 1e-20, 0, 1/np.where(det == 0, 1, det))
    # glTF: v runs down the picture, bitangent points to -v  ->  handedness handled through w
    T = (e1*d2[:, 1:2]-e2*d1[:, 1:2])*r[:, None]; B = (e2*d1[:, 0:1]-e1*d2[:, 0:1])*r[:, None]
    t = np.zeros_like(P); b = np.zeros_like(P)
    for k in range(3): np.add.at(t, i[:, k], T); np.add.at(b, i[:, k], -B)
    n = p['nrm']; t = t-n*(t*n).sum(1, keepdims=True); t /= np.maximum(np.linalg.norm(t, axis=1, keepdims=True), 1e-30)
    w = np.where((np.cross(n, t)*b).sum(1) < 0, -1., 1.)
    return np.c_[t, w]

def render(prims, M, L, V, mode, filt, size, ka, kd, ks, n, gate, srgb=False, cull=False, tangent='file'):
    import moderngl
    ctx = moderngl.create_context(standalone=True, backend='egl', libgl='libGL.so.1', libegl='libEGL.so.1')
    W, H = size; R = ctx.info['GL_RENDERER']
    prog = ctx.program(vertex_shader=VS, fragment_shader=FS)
    colour, covered = ctx.texture(size, 4), ctx.texture(size, 1); fbo = ctx.framebuffer([colour, covered], ctx.depth_renderbuffer(size))
    def tex(im):
        a, wrap, _ = im; t = ctx.texture((a.shape[1], a.shape[0]), 4, np.ascontiguousarray(a).tobytes(), **({'internal_format': 0x8C43} if (srgb and im_srgb[0]) else {}))
        t.filter = {'nearest': (0x2600, 0x2600), 'bilinear': (0x2601, 0x2601), 'trilinear': (0x2703, 0x2601)}[filt]
        if filt == 'trilinear': t.build_mipmaps()
        t.repeat_x = wrap[0] == 10497; t.repeat_y = wrap[1] == 10497
        os.environ.setdefault('PYOPENGL_PLATFORM', 'egl')
        from OpenGL import GL   # moderngl has no MIRRORED_REPEAT: set wrap modes through PyOpenGL on the same context
        GL.glBindTexture(GL.GL_TEXTURE_2D, t.glo); GL.glTexParameteri(GL.GL_TEXTURE_2D, GL.GL_TEXTURE_WRAP_S, wrap[0]); GL.glTexParameteri(GL.GL_TEXTURE_2D, GL.GL_TEXTURE_WRAP_T, wrap[1])
        return t
    im_srgb = [False]; cache = {}
    def settex(im, unit, isb):
        k = (id(im[0]), isb)
        if k not in cache: im_srgb[0] = isb; cache[k] = tex(im)
        cache[k].use(unit)
    ctx.enable(ctx.DEPTH_TEST)
    mi = {'bump': 0, 'phong': 1, 'gouraud': 2, 'flat': 3, 'tex': 4}[mode]
    fbo.use(); fbo.clear(0, 0, 0, 0, depth=1.0)
    def setu(k, v):
        if k in prog: prog[k].value = v
    for p in prims:
        i = p['idx']; tri = p['pos'][i].reshape(-1, 3, 3); fn = np.cross(tri[:, 1]-tri[:, 0], tri[:, 2]-tri[:, 0])
        fn /= np.maximum(np.linalg.norm(fn, axis=1, keepdims=True), 1e-30)
        nr = p['nrm'][i] if p['nrm'] is not None else np.repeat(fn, 3, 0)
        if p['nrm'] is None: p['nrm'] = np.zeros_like(p['pos']); p['nrm'][i] = nr
        tn = p['tan'] if (p['tan'] is not None and tangent != 'vertex') else (vertex_tangents(p) if p['nmap'] is not None else np.zeros((len(p['pos']), 4)))
        vb = np.concatenate([p['pos'][i], nr, np.repeat(fn, 3, 0), p['uv'][i], tn[i]], 1).astype('f4')
        vbo = ctx.buffer(vb.tobytes()); names = [('3f', 'pos', 3), ('3f', 'nrm', 3), ('3f', 'fnrm', 3), ('2f', 'uv', 2), ('4f', 'tan', 4)]
        fmt = ' '.join(f if a in prog else f'{c*4}x' for f, a, c in names); vao = ctx.vertex_array(prog, [(vbo, fmt, *[a for _, a, _ in names if a in prog])])
        setu('M', tuple(np.asarray(M, 'f4').T.reshape(-1))); setu('mode', mi); setu('L', tuple(L)); setu('V', tuple(V)); setu('K', (ka, kd, ks, n)); setu('gate', int(gate))
        setu('factor', tuple(map(float, p['factor']))); setu('hasBase', int(p['base'] is not None)); setu('hasN', int(p['nmap'] is not None)); setu('nscale', float(p['nscale']));
        setu('base', 0); setu('nmap', 1)
        if p['base'] is not None: settex(p['base'], 0, True)
        if p['nmap'] is not None: settex(p['nmap'], 1, False)
        (ctx.enable if cull and not p['ds'] else ctx.disable)(ctx.CULL_FACE); ctx.front_face = 'cw' if p['det'] < 0 else 'ccw'
        vao.render(moderngl.TRIANGLES)
    read = lambda texture, depth: np.frombuffer(texture.read(alignment=1), np.uint8).reshape(H, W, depth)[::-1]
    return read(colour, 4), read(covered, 1) > 0, R

if __name__ == '__main__':
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument('model'); ap.add_argument('out'); ap.add_argument('--mode', default='bump', choices=['bump', 'phong', 'gouraud', 'flat', 'tex'])
    ap.add_argument('--filter', default='bilinear', choices=['nearest', 'bilinear', 'trilinear']); ap.add_argument('--viewproj', nargs='+')
    ap.add_argument('--L', nargs=3, type=float); ap.add_argument('--V', nargs=3, type=float); ap.add_argument('--size', nargs=2, type=int, default=[512, 512])
    ap.add_argument('--az', type=float, default=30); ap.add_argument('--el', type=float, default=20)
    for k, v in dict(ka=.1, kd=.8, ks=.4, n=32.).items(): ap.add_argument('--'+k, type=float, default=v)
    ap.add_argument('--gate', action='store_true'); ap.add_argument('--srgb', action='store_true'); ap.add_argument('--cull', action='store_true'); ap.add_argument('--unlit-base', action='store_true', help='drop base texture/factor (white)')
    ap.add_argument('--tangent', default='file', choices=['file', 'vertex']); ap.add_argument('--raw')
    a = ap.parse_args(); prims = load_any(a.model)
    if a.unlit_base:
        for p in prims: p['base'] = None; p['factor'] = np.ones(4)
    M, V = auto_cam(prims, *a.size, a.az, a.el)
    if a.viewproj:
        if len(a.viewproj) == 1: j = json.load(open(a.viewproj[0])); M = np.array(j['viewproj']).reshape(4, 4); V = np.array(j.get('V', V)); a.L = a.L or j.get('L')
        else: M = np.array(list(map(float, a.viewproj))).reshape(4, 4)
    if a.V: V = np.array(a.V)
    L = np.array(a.L if a.L else [.4, .8, .45]); L = L/np.linalg.norm(L); V = V/np.linalg.norm(V)
    png, covered, R = render(prims, M, L, V, a.mode, a.filter, tuple(a.size), a.ka, a.kd, a.ks, a.n, a.gate, a.srgb, a.cull, a.tangent)
    im = png.copy(); im[..., 3] = 255; Image.fromarray(im).save(a.out)
    json.dump(dict(viewproj=[float(x) for x in M.reshape(-1)], V=V.tolist(), L=L.tolist(), ka=a.ka, kd=a.kd, ks=a.ks, n=a.n, size=a.size, mode=a.mode, filter=a.filter, renderer=R), open(os.path.splitext(a.out)[0]+'.cam.json', 'w'))
    if a.raw: np.concatenate([png[..., :3], covered.astype(np.uint8)], 2).tofile(a.raw)
    print(R, '| prims', len(prims), 'tris', sum(len(p['idx'])//3 for p in prims), 'tangents', [p['tan'] is not None for p in prims][:3], 'nmap', [p['nmap'] is not None and p['nmap'][0].shape for p in prims][:3], 'covered px', int(covered.sum()))
