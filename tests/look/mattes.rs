use abbe::film::{Manifest, id};

use super::files::Exr;
use super::view::pixels;
use crate::support::run::{Folder, render};

/// Writes four pixels: one all ball, one half ball, a quarter floor and a quarter empty, one covered by an object that
/// no name belongs to, and one empty.
fn mattes(folder: &Folder) {
    mattes_with(folder, "a.exr", 0.5);
}

/// Writes the pixels of [`mattes`], with a given coverage of the ball in the first rank of the second pixel.
fn mattes_with(folder: &Folder, file: &str, covered: f32) {
    let value_of = |name: &str| f32::from_bits(id(name));
    let (ball, floor, other) = (value_of("ball"), value_of("floor.left"), value_of("another"));
    let channels = vec![
        ("CryptoObject00.r", vec![ball, ball, other, 0.0]),
        ("CryptoObject00.g", vec![1.0, covered, 1.0, 0.0]),
        ("CryptoObject00.b", vec![0.0, floor, 0.0, 0.0]),
        ("CryptoObject00.a", vec![0.0, 0.25, 0.0, 0.0]),
        ("CryptoObject01.r", vec![0.0, 0.0, 0.0, 0.0]),
        ("CryptoObject01.g", vec![0.0, 0.25, 0.0, 0.0]),
        ("CryptoObject01.b", vec![0.0; 4]),
        ("CryptoObject01.a", vec![0.0; 4]),
        ("R", vec![0.5; 4]),
        ("G", vec![0.5; 4]),
        ("B", vec![0.5; 4]),
    ];
    let manifest = Manifest::new("CryptoObject", ["ball", "floor.left"].into_iter());
    let texts = vec![
        ("cryptomatte/3ae39a5/name", "CryptoObject".to_owned()),
        ("cryptomatte/3ae39a5/manifest", manifest.json()),
    ];
    folder.write(file, Exr { texts, ..Exr::new([4, 1], channels) }.bytes());
}

#[test]
fn one_matte_is_the_coverage_of_its_name() {
    let folder = Folder::new();
    mattes(&folder);
    let shown = |name: &str| pixels(&folder, &[name]);
    assert_eq!(shown("CryptoObject.ball"), (vec![[255; 3], [128; 3], [0; 3], [0; 3]], String::new()));
    assert_eq!(shown("CryptoObject.floor.left").0, [[0; 3], [64; 3], [0; 3], [0; 3]]);
}

#[test]
fn all_mattes_have_colors_of_their_own_by_their_coverage() {
    let folder = Folder::new();
    mattes(&folder);
    let (shown, printed) = pixels(&folder, &["CryptoObject"]);
    assert_eq!((shown.len(), &*printed), (4, ""));
    let linear = |pixel: [u8; 3]| {
        // IEC 61966-2-1.
        let value_of = |x: f64| if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
        pixel.map(|x| value_of(f64::from(x) / 255.0))
    };
    let [ball, edge, other, nothing] = [0, 1, 2, 3].map(|at| linear(shown[at]));
    assert!(ball != other && nothing == [0.0; 3], "{shown:?}");
    // The ball's share of it, plus at most a quarter of something else.
    assert!((0..3).all(|i| (-0.01..=0.26).contains(&(edge[i] - 0.5 * ball[i]))), "{shown:?}");
    assert!((0..3).any(|i| edge[i] - 0.5 * ball[i] > 0.02), "{shown:?}");
}

#[test]
fn mattes_of_a_render_are_shown_by_the_names_of_its_objects() {
    let folder = Folder::with("balls.toml", super::view::SCENE);
    let set = ["--set", "film.layers=[\"CryptoObject\"]", "--set", "film.multipart=true"];
    let made = render(&folder, &[&["balls.toml", "--exr", "a.exr"], &set[..]].concat());
    assert_eq!(made.code, Some(0), "{}", made.stderr);
    let (ball, _) = pixels(&folder, &["CryptoObject.object 1"]);
    // The ball fills the middle of the image but none of its corners.
    assert_eq!([ball[8], ball[0]], [[255; 3], [0; 3]]);
    let (all, _) = pixels(&folder, &["CryptoObject"]);
    assert_eq!(pixels(&folder, &["CryptoObject00"]).0, all);
    assert!(all[8] != [0; 3] && all[0] == [0; 3], "{all:?}");
}

#[test]
fn an_unknown_matte_is_refused_with_the_nearest_name() {
    let folder = Folder::new();
    mattes(&folder);
    let view = |arguments: &[&str]| render(&folder, &[&["view", "a.exr", "--png", "b.png"], arguments].concat());
    let near = "error: a.exr has no bal in CryptoObject\nhelp: did you mean ball? it has ball, floor.left\n";
    view(&["CryptoObject.bal"]).assert_refused(2, near);
    let tone = "error: --tone is for colors, and CryptoObject has none\nhelp: leave it out\n";
    view(&["CryptoObject", "--tone", "hable"]).assert_refused(2, tone);
    let misspelt = view(&["crptoobject"]);
    let near = "error: a.exr has no layer crptoobject\nhelp: did you mean CryptoObject? it has ";
    assert!(misspelt.code == Some(2) && misspelt.stderr.starts_with(near), "{}", misspelt.stderr);
    let other = view(&["CryptoMaterial"]);
    assert!(other.stderr.starts_with("error: a.exr has no layer CryptoMaterial\n"), "{}", other.stderr);
    assert_eq!(folder.file_names(), ["a.exr"]);
}

#[test]
fn mattes_are_compared_by_what_they_cover() {
    let folder = Folder::new();
    mattes(&folder);
    mattes_with(&folder, "b.exr", 0.25);
    let diff = |layer: &str, more: &[&str]| {
        let answer = render(&folder, &[&["diff", "a.exr", "b.exr", "--layer", layer], more].concat());
        let words = answer.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        (answer.code, words, answer.stderr)
    };
    let hint = "the image is equal, the layer CryptoObject is not; --layer CryptoObject compares it";
    let plain = render(&folder, &["diff", "a.exr", "b.exr"]);
    assert!(plain.code == Some(1) && plain.stdout.contains(hint), "{}", plain.stdout);
    let worst = "worst pixel (1, 0): 0.5 and 0.25";
    // The numbers that stand for names are not colors. All layers that hold some of them are compared in the same way.
    for layer in ["CryptoObject", "CryptoObject00", "CryptoObject01", "CryptoObject.ball"] {
        let (code, printed, _) = diff(layer, &[]);
        // 0.25^2 / (0.25^2 + 0.01), over four pixels.
        assert!(
            code == Some(1) && printed.contains("relMSE 0.21552") && printed.ends_with(worst),
            "{layer}: {printed}"
        );
        assert_eq!(diff(layer, &["--tolerance", "0.216"]).0, Some(0));
    }
    let same = (Some(0), "a.exr and b.exr agree: all values are equal".to_owned(), String::new());
    assert_eq!(diff("CryptoObject.floor.left", &[]), same);
    let near = "error: a.exr has no bal in CryptoObject\nhelp: did you mean ball? it has ball, floor.left\n";
    assert_eq!(diff("CryptoObject.bal", &[]), (Some(2), String::new(), near.to_owned()));
    let (code, _, printed) = diff("CryptObject", &[]);
    let near = "error: a.exr has no layer CryptObject\nhelp: did you mean CryptoObject? it has ";
    assert!(code == Some(2) && printed.starts_with(near), "{printed}");
}
