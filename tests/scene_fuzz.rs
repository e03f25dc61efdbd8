//! No text makes the scene reader panic, and what it accepts can be rendered.
//!
//! The cases are the same in every run. For a longer hunt: `PROPTEST_CASES=100000 PROPTEST_RNG_SEED=5 cargo test --test
//! all scene_fuzz::`.

mod edits;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use abbe::Error;
use abbe::film::Window;
use abbe::plan::plan;
use abbe::scene::{Scene, Source};
use abbe::spectrum::Curve;
use abbe::trace::{prepare, render};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use crate::support::repository::scenes;
use edits::{apply_edit, change, edit};

fn cases(cases: u32) -> ProptestConfig {
    let given = ProptestConfig::default();
    let chosen = |name: &str| std::env::var_os(name).is_some();
    ProptestConfig {
        cases: if chosen("PROPTEST_CASES") { given.cases } else { cases },
        rng_seed: if chosen("PROPTEST_RNG_SEED") { given.rng_seed } else { RngSeed::Fixed(1) },
        failure_persistence: None,
        ..given
    }
}

/// All scenes that come with Abbe, and one that uses every feature.
static SCENES: LazyLock<Vec<(PathBuf, String)>> = LazyLock::new(|| {
    let paths = scenes().into_iter().chain(["tests/messages/everything.toml".into()]);
    paths.map(|path| (path.clone(), fs::read_to_string(path).expect("a scene is text"))).collect()
});

/// Returns the scene if the text is one. Otherwise checks that the refusal can be displayed.
fn read(path: &Path, text: String) -> Option<Scene<Curve>> {
    let source = Source { path: path.to_owned(), text };
    match source.compile() {
        Ok(mut scene) => {
            // Only a small part of a small image is rendered, because sizes affect nothing but the time.
            scene.film.width = scene.film.width.min(64);
            scene.film.height = scene.film.height.min(48);
            scene.film.crop = None;
            let whole = scene.film.window();
            scene.film.crop = Some(Window { width: whole.width.min(4), height: whole.height.min(3), ..whole });
            scene.render.samples = scene.render.samples.map(|samples| samples.min(1));
            Some(scene)
        }
        Err(Error::Scene(mistakes)) => {
            assert!(!mistakes.is_empty() && mistakes.is_sorted_by_key(|mistake| mistake.span.start), "{mistakes:?}");
            for mistake in mistakes {
                assert!(!mistake.message.is_empty() && !mistake.message.contains('\n'), "{mistake:?}");
                assert!(mistake.span.start <= mistake.span.end && mistake.span.end <= source.text.len(), "{mistake:?}");
                let whole = |at| source.text.is_char_boundary(at);
                assert!(whole(mistake.span.start) && whole(mistake.span.end), "{mistake:?}");
                let (line, column) = mistake.line_and_column();
                assert!(line >= 1 && column >= 1 && line <= source.text.lines().count() + 1, "{mistake:?}");
            }
            None
        }
        Err(other) => panic!("a text is refused with its place, not with {other:?}"),
    }
}

#[test]
fn the_scenes_themselves_are_valid() {
    for (path, text) in &*SCENES {
        assert!(read(path, text.clone()).is_some(), "{}", path.display());
    }
}

proptest! {
    #![proptest_config(cases(4000))]

    #[test]
    fn random_bytes_are_refused_without_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        read(Path::new("random.toml"), String::from_utf8_lossy(&bytes).into_owned());
    }

    #[test]
    fn random_pieces_of_scenes_are_refused_without_a_panic(pieces in prop::collection::vec(piece(), 0..60)) {
        read(Path::new("pieces.toml"), pieces.concat());
    }
}

fn piece() -> impl Strategy<Value = &'static str> {
    prop::sample::select(
        [
            "[",
            "]",
            "[[",
            "]]",
            "{",
            "}",
            "=",
            ".",
            ",",
            "\n",
            " ",
            "\"",
            "'''",
            "#",
            "\\",
            "1",
            "-",
            "e",
            "nan",
            "camera",
            "film",
            "render",
            "material",
            "object",
            "light",
            "shape",
            "sphere",
            "transform",
            "diffuse",
            "position",
            "width",
            "scale",
            "rgb",
            "sun",
            "model",
            "bands",
            "lines",
            "illuminant",
            "luminance",
            "[camera]\n",
            "[[object]]\n",
            "[material.a]\n",
            " = { ",
            " }\n",
            "\u{feff}",
        ]
        .as_slice(),
    )
}

proptest! {
    #![proptest_config(cases(1500))]

    #[test]
    fn edited_scenes_are_read_or_refused_without_a_panic(
        scene in any::<prop::sample::Index>(),
        edits in prop::collection::vec(edit(), 1..8),
    ) {
        let (path, text) = scene.get(&SCENES);
        read(path, edits.iter().fold(text.clone(), |text, edit| apply_edit(&text, edit)));
    }
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn what_is_accepted_renders_to_finite_light(
        scene in any::<prop::sample::Index>(),
        changes in prop::collection::vec(change(), 1..3),
    ) {
        let (path, text) = scene.get(&SCENES);
        if let Some(scene) = read(path, changes.iter().fold(text.clone(), |text, change| apply_edit(&text, change))) {
            let (_, report) = render(&prepare(&scene, plan(&scene).method), &|_| {});
            prop_assert_eq!(report.non_finite, 0);
        }
    }
}
