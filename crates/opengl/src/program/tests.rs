//! Tests of the position that vertex programs compute.

use super::*;

fn read(body: &str) -> Result<(String, String), String> {
    read_source(&format!(
        "#version 330\n#define other main() {{ }}\nuniform mat4 P; // main() {{\nvoid main ( void )\n{{ {body} }}\nvoid other() {{}}"
    ))
}

fn read_source(source: &str) -> Result<(String, String), String> {
    let is_matrix = |name: &str| ["P", "V", "M", "MVP"].contains(&name);
    let is_attribute = |name: &str| ["position", "corner", "gl_Vertex"].contains(&name);
    let names = ProgramNames { is_matrix: &is_matrix, is_attribute: &is_attribute };
    position_of(source, &names).map(|product| (product.matrices.join(" "), product.position.unwrap()))
}

#[test]
fn products_are_followed_through_assignments() {
    let ok = |matrices: &str| Ok((matrices.to_owned(), "position".to_owned()));
    assert_eq!(read("gl_Position = MVP * vec4(position, 1.0);"), ok("MVP"));
    assert_eq!(read("gl_Position = P * V * M * position;"), ok("P V M"));
    assert_eq!(read("mat4 vp = P * V; vec4 w = M * vec4(position.xyz, 1.); gl_Position = vp * w;"), ok("P V M"));
    assert_eq!(read("vec4 p = vec4(position, 0.0, 1.0f); gl_Position = (P * (V * M)) * (p);"), ok("P V M"));
    assert_eq!(read("if (true) { color = vec3(1.0); } /* } */ gl_Position = MVP * vec4(position);"), ok("MVP"));
    let fixed = || ("gl_ProjectionMatrix gl_ModelViewMatrix".to_owned(), "gl_Vertex".to_owned());
    assert_eq!(read("gl_Position = ftransform();"), Ok(fixed()));
    assert_eq!(read("gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;"), Ok(fixed()));
    assert_eq!(read("gl_Position = gl_ProjectionMatrix * gl_ModelViewMatrix * gl_Vertex;"), Ok(fixed()));
}

#[test]
fn other_programs_are_refused_by_their_text() {
    let refused = |body: &str, part: &str| {
        let text = read(body).unwrap_err();
        assert!(text.contains(part), "{text}");
    };
    refused("gl_Position = MVP * vec4(position + wave, 1.0);", "computes `gl_Position = MVP * vec4 ( position + wave , 1.0 )`");
    refused("gl_Position = vec4(position, 1.0) * MVP;", "computes");
    refused("gl_Position = position * MVP * position;", "computes");
    refused("gl_Position = MVP * vec4(position, 2.0);", "computes");
    refused("vec4 p = vec4(position, 1.0); p.y = 2.0; gl_Position = MVP * p;", "computes");
    refused("vec4 p = vec4(position, 1.0); if (a) { p = vec4(corner, 1.0); } gl_Position = MVP * p;", "computes");
    refused("gl_Position = MVP * vec4(position, 1.0); gl_Position.z = 0.0;", "computes `gl_Position.z = 0.0`");
    refused("gl_Position = MVP * vec4(position, 1.0); gl_Position += x;", "computes");
    refused("gl_Position = unknown * vec4(position, 1.0);", "computes");
    refused("gl_Position = MVP;", "computes");
    refused(
        "vec4 p = vec4(position.x, wave, 0.0, 1.0); gl_Position = MVP * p;",
        "computes `gl_Position = MVP * p`, where `vec4 p = vec4 ( position.x , wave , 0.0 , 1.0 )`",
    );
    refused("x = 1.0;", "does not assign `gl_Position`");
}

const PLAIN: &str = "gl_Position = MVP * vec4(position, 1.0);";

#[test]
fn control_flow_of_the_position_is_refused() {
    for body in [
        "if (true) gl_Position = MVP * position; else gl_Position = P * position;",
        "for (int i = 0; i < 4; i++) gl_Position = MVP * position;",
        "do gl_Position = MVP * position; while (again);",
        "vec4 p = M * position; for (int i = 0; i < 4; i = i + 1) p = V * p; gl_Position = P * p;",
        "vec4 p = M * position; if (a) if (b) p = V * p; gl_Position = P * p;",
        "gl_Position = P * position; return; gl_Position = MVP * position;",
        "if (a) { return; } gl_Position = MVP * position;",
        "switch (a) { case 0: gl_Position = MVP * position; }",
    ] {
        assert!(read(body).is_err(), "{body}");
    }
    let text = read(&format!("if (a) return; {PLAIN}")).unwrap_err();
    assert!(text.starts_with("has a `return` before `gl_Position = MVP"), "{text}");
    assert!(read(&format!("if (a) color = x; else color = y; {PLAIN} if (a) {{ fog = gl_Position.z; return; }}")).is_ok());
}

#[test]
fn variable_that_hides_or_changes_is_refused() {
    for body in [
        "mat4 MVP = mat4(2.0); gl_Position = MVP * position;",
        "mat4 a = P, MVP = mat4(2.0); gl_Position = MVP * position;",
        "mat4 a, MVP; gl_Position = MVP * position;",
        "mat4 MVP; gl_Position = MVP * position;",
        "vec4 p = M * position; x = p = corner * 2.0; gl_Position = P * p;",
        "vec4 p = M * position; p++; gl_Position = P * p;",
        "vec4 p = M * position; x = p++; gl_Position = P * p;",
        "vec4 p = M * position; p . y = 2.0; gl_Position = P * p;",
        "mat4 m = M; m[i] = x; gl_Position = m * position;",
    ] {
        assert!(read(body).is_err(), "{body}");
    }
}

#[test]
fn preprocessor_conditions_of_code_are_refused() {
    let main = format!("void main() {{ {PLAIN} }}");
    let refused = |source: &str, part: &str| {
        let text = read_source(source).unwrap_err();
        assert!(text.contains(part), "{text}");
    };
    refused(&format!("void main() {{ {PLAIN}\n#if 0\ngl_Position = P * position;\n#endif\n}}"), "has code under `#if 0`");
    refused(&format!("# ifndef FOO\n{main}\n#else\nvoid main() {{}}\n#endif"), "has code under `#ifndef FOO`");
    refused(&format!("#define MVP \\\n P\n{main}"), "uses the macro `MVP` in `main`");
    let harmless = "#ifdef GL_ES\n#ifdef HIGH\nprecision highp float;\n#endif\nvarying vec3 v;\n#endif\n#define ONE 1.0f\n";
    assert!(read_source(&format!("{harmless}void main() {{ x = ONE; {PLAIN} }}")).is_ok());
}

#[test]
fn other_functions_change_no_position() {
    let text = read_source(&format!("void f() {{ gl_Position = P * position; }} void main() {{ {PLAIN} f(); }}")).unwrap_err();
    assert_eq!(text, "uses `gl_Position` outside `main`");
    let of_p = "vec4 p = M * position; f(p); gl_Position = P * p;";
    assert!(read_source(&format!("void f(inout vec4 q) {{ q *= 2.0; }} void main() {{ {of_p} }}")).is_err());
    assert!(read_source(&format!("void f(vec4 q) {{ q *= 2.0; }} void main() {{ {of_p} }}")).is_ok());
    let global = "void main() { p = M * position; f(); gl_Position = P * p; }";
    assert!(read_source(&format!("vec4 p; void f() {{ p *= 2.0; }} {global}")).is_err());
    assert!(read_source(&format!("vec4 p; void f() {{ x = p; }} {global}")).is_ok());
    let declared = "void main(); invariant gl_Position; out gl_PerVertex { vec4 gl_Position; }; void f() { x = 1.0; }";
    assert!(read_source(&format!("{declared} void main() {{ {PLAIN} }}")).is_ok());
}

#[test]
fn samplers_are_found_by_type() {
    assert_eq!(samplers("uniform sampler2D a;\nuniform lowp sampler2D b; uniform samplerCube c; // sampler2D d"), ["a", "b"]);
}
