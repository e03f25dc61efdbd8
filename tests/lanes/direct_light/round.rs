use std::f64::consts::PI;

use abbe::math::DVec3;

use super::{Case, assert_closed_forms, ball_irradiance, case, lamp, quad_irradiance};

/// Returns cases of balls, ellipsoids and boxes.
fn round_lights() -> Vec<Case> {
    let ball = |center: [f64; 3], radius: f64| format!("sphere = {{ center = {center:?}, radius = {radius:?} }}");
    let ball_case =
        |name, center, radius| case(name, &[&ball(center, radius)], ball_irradiance([0.0; 3], center, radius));
    let touching = |name, x: f64| Case {
        point: [x, 0.0, 0.0],
        // The camera looks in below the side of the ball.
        camera: [x + 9.0, 9.0 * x, 0.0],
        irradiance: ball_irradiance([x, 0.0, 0.0], [0.0, 1.0, 0.0], 1.0),
        ..case(name, &[&ball([0.0, 1.0, 0.0], 1.0)], 0.0)
    };
    // Half of the ball is above the horizon. Its projection is the segment that its edge cuts off the unit disc
    // (Nusselt 1928).
    let angle = libm::asin(0.5);
    let stretched = |name, steps: &str, irradiance| Case {
        scene: lamp("", &[])
            + &format!(
                "[[object]]\nshape.sphere = {{ center = [0, 0, 0], radius = 1 }}\nmaterial = \"lamp\"\n\
                 transform = [{steps}]\n"
            ),
        ..case(name, &[], irradiance)
    };
    // The cone tangent to an upright ellipsoid of half axes a, h, b meets height 1 in an ellipse. Over that ellipse,
    // the integral of 1 / (1 + x^2 + z^2)^2 is pi A B / sqrt((1 + A^2) (1 + B^2)).
    let (a, h, b, height) = (1.0, 0.3, 0.5, 2.0f64);
    let [a, b] = [a, b].map(|x: f64| x / (height * height - h * h).sqrt());
    let ellipse = PI * a * b / ((1.0 + a * a) * (1.0 + b * b)).sqrt();
    let turned =
        "{ scale = [1, 0.3, 0.5] }, { rotate = { axis = [0, 1, 0], degrees = 30 } }, { translate = [0, 2, 0] }";
    let (center, half) = (DVec3::new(0.9, 1.1, -0.5), DVec3::new(0.4, 0.3, 0.6));
    let face = |axis: DVec3, sign: f64| {
        let [u, v] = [DVec3::new(axis.y, axis.z, axis.x), DVec3::new(axis.z, axis.x, axis.y)];
        quad_irradiance([0.0; 3], center + axis * half * sign, u * half, v * half)
    };
    let sides = face(DVec3::Y, -1.0) + face(DVec3::X, -1.0);
    let cube = "cube = { center = [0.9, 1.1, -0.5], size = [0.8, 0.6, 1.2] }";
    let (low, high) = ((center - half).to_array(), (center + half).to_array());
    let corner =
        |i: usize| format!("{:?}", [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { high[axis] } else { low[axis] }));
    let box_mesh = format!(
        "mesh = {{ points = [{}], faces = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], \
         [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]] }}",
        (0..8).map(corner).collect::<Vec<_>>().join(", ")
    );
    vec![
        ball_case("ball overhead", [0.0, 3.0, 0.0], 1.0),
        ball_case("ball aside", [-2.0, 1.5, 1.0], 0.8),
        ball_case("L1 ball far away", [60.0, 80.0, 0.0], 0.01),
        touching("ball that touches the floor", 0.5),
        touching("ball that touches the floor close by", 0.05),
        case("ball half below the floor", &[&ball([-2.0, 0.0, 0.0], 1.0)], angle - libm::sin(angle) * libm::cos(angle)),
        case("L2 inside a ball", &[&ball([0.5, 0.3, 0.2], 20.0)], PI),
        stretched("ellipsoid overhead", turned, ellipse),
        stretched("inside an ellipsoid", "{ scale = [20, 30, 15] }, { translate = [1, 2, 3] }", PI),
        // The faces of this box at -x and -y are toward the point.
        case("box", &[cube], sides),
        case("box of a mesh", &[&box_mesh], sides),
    ]
}

#[test]
fn round_lights_send_what_their_outlines_enclose() {
    assert_closed_forms(&round_lights());
}
