//! Tests of views.

use super::*;
use crate::camera::Projection;

fn hints(lamps: Vec<(LightSource, f64)>) -> ViewHints {
    ViewHints::still(WorldBounds { low: DVec3::new(1., 0., 0.), high: DVec3::new(3., 2., 2.) }, None, lamps)
}

#[test]
fn frame_k_of_n_turns_by_k_nths_of_the_angle() {
    let options = ViewOptions { orbit_degrees: Some(360.0), frames: Some(4), ..ViewOptions::default() };
    let frames = hints(vec![]).frames(&options).unwrap();
    let azimuth = |f: &Frame| libm::atan2(f.camera.to_viewer[0], f.camera.to_viewer[2]).to_degrees();
    for (k, frame) in frames.iter().enumerate() {
        let expected = [30.0, 120.0, -150.0, -60.0][k];
        assert!((azimuth(frame) - expected).abs() < 1e-9, "{}", azimuth(frame));
        let centre = DMat4::from_cols_array(&frame.camera.view_projection).transpose() * DVec4::new(2., 1., 1., 1.);
        assert!(centre.x.abs() < 1e-9 && centre.y.abs() < 1e-9, "the centre stays in the middle");
    }
    // Looking from the other side mirrors left and right of the model.
    let x = |f: &Frame| (DMat4::from_cols_array(&f.camera.view_projection).transpose() * DVec4::new(3., 1., 1., 1.)).x;
    assert!((x(&frames[0]) + x(&frames[2])).abs() < 1e-9);
}

#[test]
fn camera_turns_around_and_then_up() {
    let seen = |around, up| {
        let options = ViewOptions { turn: Some([around, up]), ..ViewOptions::default() };
        let [x, y, z] = hints(vec![]).frames(&options).unwrap()[0].camera.to_viewer;
        [libm::atan2(x, z).to_degrees(), libm::asin(y).to_degrees()]
    };
    for (around, up) in [(0.0, 0.0), (50.0, 0.0), (0.0, 30.0), (-75.0, 40.0), (90.0, -60.0)] {
        let [azimuth, elevation] = seen(around, up);
        assert!((azimuth - 30.0 - around).abs() < 1e-9 && (elevation - 20.0 - up).abs() < 1e-9, "{azimuth} {elevation}");
    }
}

#[test]
fn zoom_keeps_the_centre_of_the_picture() {
    let place = |zoom, point: DVec3| {
        let options = ViewOptions { zoom, ..ViewOptions::default() };
        let camera = hints(vec![]).frames(&options).unwrap()[0].camera;
        let clip = DMat4::from_cols_array(&camera.view_projection).transpose() * point.extend(1.0);
        [clip.x / clip.w, clip.y / clip.w, clip.z / clip.w]
    };
    let corner = DVec3::new(3.0, 0.5, 0.0);
    let ([x, y, z], near) = (place(None, corner), place(Some(2.0), corner));
    assert_eq!(near, [2.0 * x, 2.0 * y, z]);
    assert!(place(Some(2.0), DVec3::new(2.0, 1.0, 1.0))[0].abs() < 1e-12);
}

#[test]
fn light_turns_with_its_own_orbit() {
    let options =
        ViewOptions { light: Some([0., 0., 5.]), light_orbit_degrees: Some(180.0), frames: Some(2), ..ViewOptions::default() };
    let frames = hints(vec![]).frames(&options).unwrap();
    assert_eq!(frames[0].camera.to_light, [0., 0., 1.]);
    let turned = DVec3::from_array(frames[1].camera.to_light);
    assert!((turned - DVec3::X).length() < 1e-12, "{turned:?}");
    assert_eq!(frames[0].camera.view_projection, frames[1].camera.view_projection);
}

// Claim: defer, views: A file of views gives the frames of equal command-line options. An error names its place.
#[test]
fn own_views_equal_the_same_options() {
    let turning = ViewHints { frames: 4, orbit: 360.0, light_orbit: LightOrbit::WithCamera, ..hints(vec![]) };
    let own = |orbit_degrees| OwnView { orbit_degrees, ..OwnView::default() };
    let lit = OwnView { light: Some([0., 0., 2.]), light_orbit_degrees: Some(90.0), zoom: Some(2.0), ..own(None) };
    let options = ViewOptions { turn: Some([10.0, 5.0]), ..ViewOptions::default() };
    let views = vec![own(None), own(Some(90.0)), own(Some(180.0)), own(Some(270.0)), lit];
    let seen = turning.frames(&ViewOptions { views, frames: Some(9), orbit_degrees: Some(1.0), ..options.clone() }).unwrap();
    assert_eq!(seen.len(), 5);
    assert_eq!(seen[..4], turning.frames(&options).unwrap(), "the model's orbit, step by step");
    let to_light = DVec3::from_array(seen[4].camera.to_light);
    assert!((to_light - DVec3::X).length() < 1e-12, "{to_light:?}");
    let larger = turning.frames(&ViewOptions { zoom: Some(2.0), frames: Some(1), ..options }).unwrap();
    assert_eq!(seen[4].camera.view_projection, larger[0].camera.view_projection);
}

#[test]
fn invalid_view_is_named_by_its_place() {
    let refused = |own: OwnView| OwnView::check(&[OwnView::default(), own]).unwrap_err().to_string();
    let d = OwnView::default;
    assert!(refused(OwnView { zoom: Some(0.0), ..d() }).starts_with("/views/1/zoom: 0; expected a number from 0.01 to 100"));
    assert!(refused(OwnView { turn: Some([0.0, f64::NAN]), ..d() }).starts_with("/views/1/turn: NaN; expected"));
    assert!(refused(OwnView { orbit_degrees: Some(f64::INFINITY), ..d() }).starts_with("/views/1/orbit: inf; expected"));
    assert!(refused(OwnView { light: Some([0.0; 3]), ..d() }).starts_with("/views/1/light: "));
    let flat = Camera { view_projection: [0.0; 16], to_light: [1., 0., 0.], to_viewer: [0., 0., 1.] };
    assert!(refused(OwnView { camera: Some(flat), ..d() }).starts_with("/views/1/camera/view_projection: "));
    assert!(OwnView::check(&[d()]).is_ok());
}

#[test]
fn light_follows_orbiting_camera() {
    let turning = ViewHints { frames: 4, orbit: 360.0, light_orbit: LightOrbit::WithCamera, ..hints(vec![]) };
    let seen_by_the_camera = |options: ViewOptions| {
        let frames = turning.frames(&options).unwrap();
        let angle = |v: [f64; 3]| libm::atan2(v[0], v[2]).to_degrees();
        frames.iter().map(|f| (angle(f.camera.to_light) - angle(f.camera.to_viewer)).rem_euclid(360.0).round()).collect()
    };
    let own: Vec<f64> = seen_by_the_camera(ViewOptions::default());
    assert_eq!(own, [own[0]; 4]);
    assert_eq!(seen_by_the_camera(ViewOptions { orbit_degrees: Some(90.0), ..ViewOptions::default() }), own);
    let standing: Vec<f64> = seen_by_the_camera(ViewOptions { light_orbit_degrees: Some(0.0), ..ViewOptions::default() });
    assert_ne!(standing[1], own[1]);
}

#[test]
fn light_option_precedes_camera_file_and_model() {
    let camera = Camera { view_projection: rows(DMat4::IDENTITY), to_light: [1., 0., 0.], to_viewer: [0., 0., 1.] };
    let lamps = vec![(LightSource::Point(DVec3::new(2., 11., 1.)), 0.5), (LightSource::Directional(DVec3::Z), 1.0)];
    let first = |options: ViewOptions| hints(lamps.clone()).frames(&options).unwrap()[0].clone();
    let own = first(ViewOptions::default());
    assert_eq!((own.lights.len(), own.camera.to_light), (2, [0., 1., 0.]));
    let file = ViewOptions { camera: Some(camera), ..ViewOptions::default() };
    assert_eq!(first(file.clone()).camera, camera);
    let user = first(ViewOptions { light: Some([0., -2., 0.]), ..file });
    assert_eq!((user.lights.len(), user.camera.to_light), (1, [0., -1., 0.]));
}

#[test]
fn options_out_of_range_are_refused() {
    let refuses = |options: ViewOptions| hints(vec![]).frames(&options).unwrap_err();
    let d = ViewOptions::default;
    refuses(ViewOptions { size: [0, 4], ..d() });
    refuses(ViewOptions { size: [4, 100_000], ..d() });
    refuses(ViewOptions { turn: Some([0.0, f64::NAN]), ..d() });
    refuses(ViewOptions { zoom: Some(0.0), ..d() });
    refuses(ViewOptions { zoom: Some(f64::NAN), ..d() });
    refuses(ViewOptions { size: [16_384, 16_384], ..d() });
    refuses(ViewOptions { frames: Some(0), ..d() });
    refuses(ViewOptions { light: Some([0.0; 3]), ..d() });
    refuses(ViewOptions { light: Some([f64::NAN; 3]), ..d() });
    refuses(ViewOptions { orbit_degrees: Some(f64::INFINITY), ..d() });
}

#[test]
fn orbit_over_single_frame_is_refused() {
    let frames = |options: ViewOptions| hints(vec![]).frames(&options);
    let orbit = ViewOptions { orbit_degrees: Some(6.0), ..ViewOptions::default() };
    let light = ViewOptions { light_orbit_degrees: Some(-6.0), ..ViewOptions::default() };
    assert!(frames(orbit.clone()).unwrap_err().to_string().starts_with("orbit: 6; expected 0 with a single frame"));
    assert!(frames(light).unwrap_err().to_string().starts_with("light_orbit: -6; expected"));
    assert!(frames(ViewOptions { frames: Some(2), ..orbit }).is_ok());
    assert!(frames(ViewOptions { orbit_degrees: Some(0.0), ..ViewOptions::default() }).is_ok());
}

#[test]
fn model_camera_is_used() {
    let lens = Projection::Orthographic { half_height: 1.0, near: 0.1, far: 10.0 };
    let mut s = hints(vec![]);
    s.camera = Viewpoint::placed(DMat4::from_translation(DVec3::new(0., 0., 5.)), lens);
    let frame = &s.frames(&ViewOptions { size: [200, 100], ..ViewOptions::default() }).unwrap()[0];
    assert_eq!(frame.camera.to_viewer, [0., 0., 1.]);
    let clip = DMat4::from_cols_array(&frame.camera.view_projection).transpose() * DVec4::new(2., 1., 0., 1.);
    assert_eq!((clip.x, clip.y, clip.w), (1.0, 1.0, 1.0), "twice as wide as high");
}
