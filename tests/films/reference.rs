//! Layers computed by a different method from the renderer's: boundary by boundary, from the far side (Rouard 1937;
//! Born & Wolf 1999, *Principles of Optics*, section 1.6.4, equation 55). Complex numbers are pairs.

type C = [f64; 2];

fn add(a: C, b: C) -> C {
    [a[0] + b[0], a[1] + b[1]]
}

fn mul(a: C, b: C) -> C {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn div(a: C, b: C) -> C {
    let square = b[0] * b[0] + b[1] * b[1];
    mul(a, [b[0] / square, -b[1] / square])
}

fn root(a: C) -> C {
    let (modulus, angle) = (a[0].hypot(a[1]).sqrt(), 0.5 * a[1].atan2(a[0]));
    let root = [modulus * angle.cos(), modulus * angle.sin()];
    if root[1] > 0.0 { [-root[0], -root[1]] } else { root }
}

fn exp_minus_i(a: C) -> C {
    let decay = a[1].exp();
    [decay * a[0].cos(), -decay * a[0].sin()]
}

/// A layer, given as n - i k and its thickness in nm.
pub type Layer = (C, f64);

/// Returns the reflected and the transmitted share of unpolarized light at a wavelength in nm, from index `n1` at a
/// cosine through layers to n2, which is n - i k.
pub fn shares(n1: f64, layers: &[Layer], n2: C, cos: f64, nm: f64) -> [f64; 2] {
    let along = n1 * n1 * (1.0 - cos * cos);
    let across = |n: C| root(add(mul(n, n), [-along, 0.0]));
    let indices: Vec<C> = [[n1, 0.0]].into_iter().chain(layers.iter().map(|layer| layer.0)).chain([n2]).collect();
    let mut sum = [0.0; 2];
    for p in [false, true] {
        let admittance = |n: C| if p { div(mul(n, n), across(n)) } else { across(n) };
        let (mut r, mut t) = ([0.0; 2], [1.0, 0.0]);
        for boundary in (0..indices.len() - 1).rev() {
            let [a, b] = [boundary, boundary + 1].map(|i| admittance(indices[i]));
            let total = add(a, b);
            let (r1, t1) = (div(add(a, [-b[0], -b[1]]), total), div([2.0 * a[0], 2.0 * a[1]], total));
            let phase = layers.get(boundary).map_or([1.0, 0.0], |&(n, thickness)| {
                exp_minus_i(across(n).map(|x| x * std::f64::consts::TAU * thickness / nm))
            });
            let back = mul(r, mul(phase, phase));
            let all = add([1.0, 0.0], mul(r1, back));
            r = div(add(r1, back), all);
            t = div(mul(t1, mul(t, phase)), all);
        }
        let factor = admittance(n2)[0] / admittance([n1, 0.0])[0];
        sum[0] += 0.5 * (r[0] * r[0] + r[1] * r[1]);
        sum[1] += 0.5 * factor * (t[0] * t[0] + t[1] * t[1]);
    }
    sum
}
