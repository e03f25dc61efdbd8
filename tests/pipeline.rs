//! The command in a pipeline: standard input and output, JSON, silence, frames.

use std::process::{Command, Output, Stdio};
use std::{fs, io::Write, thread};

use serde_json::Value;

use crate::support::run::{Answer, Folder, render};

const SCENE: &str = include_str!("messages/base.toml");

fn folder() -> Folder {
    Folder::with("scene.toml", SCENE)
}

/// Runs `render` with a text on standard input.
fn run_with_stdin(folder: &Folder, arguments: &[&str], text: &[u8]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    command.current_dir(folder.path()).args(arguments);
    let pipes = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = pipes.spawn().expect("the command can be started");
    let (mut stdin, text) = (child.stdin.take().expect("it is piped"), text.to_owned());
    // A command that refuses its arguments does not read its input.
    let feed = thread::spawn(move || stdin.write_all(&text).unwrap_or_default());
    let output = child.wait_with_output().expect("the command ends");
    feed.join().expect("the text is fed");
    output
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("messages are UTF-8")
}

/// Returns all JSON events of a kind.
fn reported(stdout: &str, kind: &str) -> Vec<Value> {
    let lines =
        stdout.lines().map(|line| serde_json::from_str::<Value>(line).unwrap_or_else(|e| panic!("{line}: {e}")));
    lines.filter(|event| event["kind"] == kind).collect()
}

#[test]
fn a_scene_may_come_from_standard_input_and_an_image_go_to_standard_output() {
    let folder = folder();
    assert_eq!(render(&folder, &["scene.toml", "--exr", "file.exr"]).code, Some(0));
    let file = folder.read("file.exr");
    let to_file = run_with_stdin(&folder, &["-", "--exr", "fed.exr"], SCENE.as_bytes());
    assert_eq!((to_file.status.code(), text(&to_file.stdout)), (Some(0), ""), "{}", text(&to_file.stderr));
    assert!(folder.read("fed.exr") == file);
    let sent = run_with_stdin(&folder, &["-", "--exr", "-", "--png", "look.png"], SCENE.as_bytes());
    assert_eq!(sent.status.code(), Some(0), "{}", text(&sent.stderr));
    assert_eq!(sent.stdout, file);
    assert!(text(&sent.stderr).ends_with("wrote look.png\n"), "{}", text(&sent.stderr));
    assert_eq!(folder.file_names(), ["fed.exr", "file.exr", "look.png", "scene.toml"]);
    let sent = run_with_stdin(&folder, &["scene.toml", "--exr", "-"], b"");
    assert_eq!(sent.stdout, file);
}

#[test]
fn a_scene_on_standard_input_is_called_so_and_finds_its_files_from_the_current_folder() {
    let folder = folder();
    folder.write("gold.toml", "material.copper.conductor.metal = \"Cu\"\n");
    let scene = format!("include = [\"gold.toml\"]\n{SCENE}");
    let checked = run_with_stdin(&folder, &["--check", "-"], format!("\u{feff}{scene}").as_bytes());
    let expected = "warning: material copper is not used by any object\n<stdin> is a valid scene: 7 objects\n";
    assert_eq!((checked.status.code(), text(&checked.stderr)), (Some(0), expected));
    let wrong = run_with_stdin(&folder, &["--check", "-"], scene.replace("width = 4", "widht = 4").as_bytes());
    assert_eq!(wrong.status.code(), Some(2));
    assert!(text(&wrong.stderr).contains("--> <stdin>:8:1\n"), "{}", text(&wrong.stderr));
    let latin = run_with_stdin(
        &folder,
        &["--check", "-"],
        "# é\n# caf".bytes().chain(*b"\xe9\n").collect::<Vec<_>>().as_slice(),
    );
    let expected = "error: the scene on standard input is not text in UTF-8: line 2 has the byte 0xE9 in column 6\n\
                    help: save it as UTF-8\n";
    assert_eq!((latin.status.code(), text(&latin.stderr)), (Some(2), expected));
}

#[test]
fn what_standard_input_and_output_cannot_do_is_refused() {
    let folder = folder();
    let name = "help: name the image, as in --exr out/frame.exr\n";
    for (arguments, expected) in [
        (
            &["-"][..],
            "error: a scene from standard input has no file name to name the image after\n\
             help: name the image, as in render - --exr out/frame.exr\n"
                .to_owned(),
        ),
        (
            &["scene.toml", "--spectral", "--exr", "-"],
            format!(
                "error: spectra are written to a file beside the image, which standard output does not allow\n{name}"
            ),
        ),
        (
            &["scene.toml", "--set", "film.spectral=true", "--exr", "-"],
            format!(
                "error: spectra are written to a file beside the image, which standard output does not allow\n{name}"
            ),
        ),
        (
            &["scene.toml", "--plan", "--exr", "-"],
            "error: --plan renders nothing, so - would not be written\nhelp: leave one of them out\n".into(),
        ),
    ] {
        let refused = run_with_stdin(&folder, arguments, SCENE.as_bytes());
        let answer = (refused.status.code(), text(&refused.stdout), text(&refused.stderr));
        assert_eq!(answer, (Some(2), "", &*expected), "{arguments:?}");
    }
    let both = run_with_stdin(&folder, &["scene.toml", "--json", "--exr", "-"], b"");
    let errors = reported(text(&both.stdout), "error");
    assert_eq!((both.status.code(), text(&both.stderr)), (Some(2), ""));
    assert_eq!(errors[0]["message"], "--json and --exr - would both write to standard output");
    assert_eq!(folder.file_names(), ["scene.toml"]);
}

#[test]
fn with_quiet_only_warnings_and_errors_are_printed() {
    let folder = folder();
    let quiet = render(&folder, &["scene.toml", "--quiet"]);
    assert_eq!((quiet.code, &*quiet.stdout, &*quiet.stderr), (Some(0), "", ""));
    let warned = render(&folder, &["scene.toml", "--quiet", "--set", "material.copper={mirror={}}"]);
    let expected = "warning: material copper is not used by any object\n";
    assert_eq!((warned.code, &*warned.stdout, &*warned.stderr), (Some(0), "", expected));
    let checked = render(&folder, &["scene.toml", "--quiet", "--check"]);
    assert_eq!((checked.code, &*checked.stdout, &*checked.stderr), (Some(0), "", ""));
    let planned = render(&folder, &["scene.toml", "--quiet", "--plan"]);
    assert!(planned.code == Some(0) && planned.stdout.starts_with("cost: ") && planned.stderr.is_empty());
    let wrong = render(&folder, &["scene.toml", "--quiet", "--set", "film.width=x"]);
    assert!(wrong.code == Some(2) && wrong.stderr.starts_with("error: "), "{}", wrong.stderr);
}

#[test]
fn with_json_every_line_is_an_object_and_nothing_else_is_printed() {
    let folder = folder();
    let sets = ["--set", "material.copper={mirror={}}"];
    let arguments: Vec<&str> =
        ["scene.toml", "--json", "--exr", "a.exr", "--png", "a.png"].into_iter().chain(sets).collect();
    let printed = render(&folder, &arguments);
    assert_eq!((printed.code, &*printed.stderr), (Some(0), ""));
    let kinds: Vec<Value> =
        printed.stdout.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON")["kind"].clone()).collect();
    assert_eq!(kinds.first().and_then(Value::as_str), Some("warning"));
    assert_eq!(reported(&printed.stdout, "plan")[0]["samples"], 1);
    let progress = reported(&printed.stdout, "progress").pop().expect("the end is told");
    assert_eq!((&progress["done"], &progress["seconds_left"]), (&progress["total"], &Value::from(0.0)));
    assert_eq!(reported(&printed.stdout, "report")[0]["samples"], 12);
    let written: Vec<Value> = reported(&printed.stdout, "written").iter().map(|event| event["path"].clone()).collect();
    assert_eq!(written, ["a.exr", "a.png"]);
    let planned = render(&folder, &["scene.toml", "--json", "--plan"]);
    let words = render(&folder, &["scene.toml", "--plan"]);
    let because = &reported(&planned.stdout, "plan")[0]["because"];
    // Times are measured, so they differ.
    let is_sure = |line: &&str| !line.starts_with("cost: ") && !line.ends_with(" times as long");
    let told_lines = because.as_array().expect("a list").iter().filter_map(Value::as_str);
    assert!(told_lines.filter(is_sure).eq(words.stdout.lines().filter(is_sure)), "{because}");
    let checked = render(&folder, &["scene.toml", "--json", "--check"]);
    assert_eq!(checked.stdout, "{\"kind\":\"checked\",\"scene\":\"scene.toml\",\"objects\":7}\n");
}

#[test]
fn with_json_mistakes_are_objects_with_their_place() {
    let folder = folder();
    let wrong = render(&folder, &["scene.toml", "--json", "--set", "film.widht=3", "--set", "render.samples=-1"]);
    assert_eq!((wrong.code, &*wrong.stderr), (Some(2), ""));
    let expected = concat!(
        r#"{"kind":"error","message":"unknown key `widht`","file":"--set","line":1,"column":6,"help":"did you mean `width`?"}"#,
        "\n",
        r#"{"kind":"error","message":"`samples` is a whole number of 1 or more, not -1","file":"--set","line":2,"column":16,"help":null}"#,
        "\n"
    );
    assert_eq!(wrong.stdout, expected);
    let missing = render(&folder, &["scen.toml", "--json"]);
    let error = &reported(&missing.stdout, "error")[0];
    assert_eq!((missing.code, &error["help"]), (Some(2), &Value::from("did you mean scene.toml?")));
    let unwritable = render(&folder, &["scene.toml", "--json", "--exr", "scene.toml/a.exr"]);
    let error = &reported(&unwritable.stdout, "error")[0];
    assert_eq!((unwritable.code, &error["file"]), (Some(1), &Value::from("scene.toml/a.exr")));
    let argument = render(&folder, &["scene.toml", "--json", "--sampels", "3"]);
    assert_eq!((argument.code, &*argument.stderr), (Some(2), ""));
    let error = &reported(&argument.stdout, "error")[0];
    assert_eq!(error["message"], "unexpected argument '--sampels' found");
}

/// Runs `render` with arguments that are separated by blanks, and with progress messages for a render farm.
fn run_for_farm(folder: &Folder, words: &str, code: i32) -> Answer {
    let answer = render(folder, &words.split(' ').chain(["--progress", "openjd"]).collect::<Vec<_>>());
    assert_eq!(answer.code, Some(code), "{words}: {}", answer.stderr);
    let printed =
        |line: &str| ["progress", "status", "fail"].iter().any(|kind| line.starts_with(&format!("openjd_{kind}: ")));
    assert!(answer.stdout.lines().all(printed), "{words}: {}", answer.stdout);
    answer
}

#[test]
fn a_farm_gets_the_progress_of_a_part_and_people_read_the_rest_in_its_log() {
    let folder = folder();
    for (words, written) in
        [("--shard 1/2 --resume", "a.1-of-2.part"), ("--shard 2/2 --checkpoint 1h", "a.2-of-2.part")]
    {
        let part =
            run_for_farm(&folder, &format!("scene.toml --exr a.exr --set material.copper={{mirror={{}}}} {words}"), 0);
        assert!(part.stdout.contains("openjd_progress: 0.0\n"), "{}", part.stdout);
        let end = part.stdout.split("openjd_progress: 100.0\n").nth(1).expect("the end is told");
        assert!(end.starts_with("openjd_status: rendered in "), "{end}");
        assert!(end.ends_with(&format!("openjd_status: wrote {written}\n")), "{end}");
        assert!(
            part.stderr.starts_with("warning: material copper is not used by any object\ncost: "),
            "{}",
            part.stderr
        );
    }
    let merged = run_for_farm(&folder, "merge a.exr a.1-of-2.part a.2-of-2.part --delete", 0);
    assert_eq!((&*merged.stdout, &*merged.stderr), ("openjd_status: wrote a.exr\n", ""));
    assert_eq!(folder.file_names(), ["a.exr", "scene.toml"]);
}

#[test]
fn what_is_no_checkpoint_of_a_part_is_not_deleted_with_it() {
    let folder = folder();
    for part in ["1/2", "2/2"] {
        run_for_farm(&folder, &format!("scene.toml --exr a.exr --shard {part}"), 0);
    }
    std::fs::create_dir(folder.path_of("a.1-of-2.checkpoint")).unwrap();
    let merged = run_for_farm(&folder, "merge a.exr a.1-of-2.part a.2-of-2.part --delete", 0);
    assert_eq!(merged.stderr, "");
    assert_eq!(folder.file_names(), ["a.1-of-2.checkpoint", "a.exr", "scene.toml"]);
}

#[test]
fn a_farm_gets_one_line_on_why_a_task_fails() {
    let folder = folder();
    for (words, code, why, log) in [
        ("scene.toml --set film.widht=3", 2, "--set:1:6: unknown key `widht`", "= help: did you mean `width`?"),
        (
            "scene.toml --set film.widht=3 --set film.heihgt=3",
            2,
            "--set:1:6: unknown key `widht`, and 1 more",
            "2 mistakes in --set",
        ),
        (
            "scene.toml --sampels 3",
            2,
            "unexpected argument '--sampels' found",
            "help: render --help lists all arguments",
        ),
        (
            "scene.toml --exr -",
            2,
            "--progress and --exr - would both write to standard output",
            "help: name the image, as in --exr out/frame.exr",
        ),
        (
            "scene.toml --exr scene.toml/a.exr",
            1,
            "cannot write scene.toml/a.exr: there is a file where its folder should be",
            "error: cannot write scene.toml/a.exr",
        ),
        ("merge a.exr scene.toml", 2, "scene.toml is not a part of an image", "help: parts are made by --shard"),
    ] {
        let failed = run_for_farm(&folder, words, code);
        assert_eq!(failed.stdout, format!("openjd_fail: {why}\n"), "{words}");
        assert!(failed.stderr.contains(log), "{words}: {}", failed.stderr);
    }
    for flag in ["--json", "--quiet", "--plan", "--check"] {
        let both = render(&folder, &["scene.toml", "--progress", "openjd", flag]);
        let printed = both.stdout + &both.stderr;
        assert!(both.code == Some(2) && printed.contains("cannot be used with"), "{flag}: {printed}");
    }
}

#[test]
fn a_frame_is_a_variable_and_a_number_in_the_names_of_files() {
    let folder = folder();
    folder.write("turn.toml", SCENE.replace("degrees = 30", "degrees = \"$frame\""));
    let frame = |arguments: &[&str]| {
        let answer =
            render(&folder, &["turn.toml", "--quiet"].into_iter().chain(arguments.iter().copied()).collect::<Vec<_>>());
        assert_eq!((answer.code, &*answer.stderr), (Some(0), ""));
    };
    frame(&["--frame", "12", "--exr", "out/%d/turn.%04d.exr", "--png", "%d%%.png"]);
    frame(&["--frame", "7"]);
    frame(&["--set", "set.frame=7", "--exr", "seven.exr"]);
    assert_eq!(folder.file_names(), ["12%.png", "out", "scene.toml", "seven.exr", "turn.0007.exr", "turn.toml"]);
    assert!(folder.path_of("out/12/turn.0012.exr").is_file());
    let bytes = |name: &str| folder.read(name);
    assert_eq!(bytes("seven.exr"), bytes("turn.0007.exr"));
    assert_ne!(bytes("seven.exr"), bytes("out/12/turn.0012.exr"));
    let nameless = render(&folder, &["scene.toml", "--exr", "turn.%04d.exr"]);
    let expected = "error: turn.%04d.exr has a place for the frame number, but no frame is given\nhelp: give its number: --frame 1\n";
    assert_eq!((nameless.code, &*nameless.stderr), (Some(2), expected));
}

#[test]
fn settings_in_any_language_stand_in_the_file() {
    let folder = folder();
    let setting = "film.metadata.owner=\"日本 – groß \u{1f352}\"";
    let parts = ["1/2", "2/2"].map(|part| format!("--shard={part}"));
    for more in [&[][..], &[&*parts[0]], &[&*parts[1]]] {
        let rendered = render(&folder, &[&["scene.toml", "--exr", "a.exr", "--set", setting], more].concat());
        assert_eq!(rendered.code, Some(0), "{}", rendered.stderr);
    }
    let merged = render(&folder, &["merge", "b.exr", "a.1-of-2.part", "a.2-of-2.part"]);
    assert_eq!(merged.code, Some(0), "{}", merged.stderr);
    for name in ["a.exr", "b.exr"] {
        let reported = render(&folder, &["info", name]).stdout;
        assert!(reported.lines().any(|line| line.contains("render/set") && line.contains(setting)), "{reported}");
    }
}

#[test]
fn a_frame_with_an_impossible_value_is_reported_before_any_is_rendered() {
    let folder = Folder::new();
    folder.write("zoom.toml", SCENE.replace("vertical_fov = 35", "vertical_fov = \"$frame\""));
    for frames in ["178-181", "178,0,179"] {
        let answer = render(&folder, &["zoom.toml", "--frame", frames, "--exr", "z.%d.exr"]);
        let wrong = if frames == "178-181" { 181 } else { 0 };
        let reported = format!("\nframe {wrong} has a mistake, so no frame is rendered\nerror: ");
        assert!(answer.code == Some(2) && answer.stderr.contains(&reported), "{}", answer.stderr);
        assert_eq!(folder.file_names(), ["zoom.toml"]);
    }
    // A mistake in all frames is reported for the first of them.
    let answer = render(&folder, &["zoom.toml", "--frame", "181-190", "--exr", "z.%d.exr"]);
    assert!(answer.code == Some(2) && answer.stderr.starts_with("frame 181, 1 of 10\nerror: "), "{}", answer.stderr);
}

#[test]
fn frames_are_rendered_one_after_another() {
    let folder = folder();
    folder.write("turn.toml", SCENE.replace("degrees = 30", "degrees = \"$frame\""));
    let frames = |arguments: &[&str]| {
        render(&folder, &["turn.toml"].into_iter().chain(arguments.iter().copied()).collect::<Vec<_>>())
    };
    let bytes = |name: &str| folder.read(name);
    assert_eq!(frames(&["--quiet", "--frame", "2", "--exr", "two.exr"]).code, Some(0));
    let several = ["--frame", "1-4x1", "--exr", "t.%d.exr", "--report", "t.%d.json", "--checkpoint", "60s"];
    let rendered = frames(&several);
    assert_eq!(rendered.code, Some(0), "{}", rendered.stderr);
    let reported: Vec<&str> = rendered.stderr.lines().filter(|line| line.starts_with("frame ")).collect();
    assert_eq!(reported, ["frame 1, 1 of 4", "frame 2, 2 of 4", "frame 3, 3 of 4", "frame 4, 4 of 4"]);
    assert!(bytes("t.2.exr") == bytes("two.exr") && bytes("t.1.exr") != bytes("t.4.exr"));
    assert!(bytes("t.3.json").starts_with(b"{"));
    // Finished frames are not rendered again.
    let fourth = bytes("t.4.exr");
    fs::remove_file(folder.path_of("t.4.exr")).expect("it was written");
    let done = frames(&[&several[..], &["--resume"]].concat());
    assert!(done.code == Some(0) && done.stderr.matches("nothing is left to do").count() == 3, "{}", done.stderr);
    assert!(bytes("t.4.exr") == fourth);
    let piped = run_with_stdin(&folder, &["-", "--frame", "3-4", "--exr", "p.%d.exr", "--quiet"], &bytes("turn.toml"));
    assert!(piped.status.code() == Some(0) && bytes("p.3.exr") == bytes("t.3.exr"), "{}", text(&piped.stderr));
    // Each frame follows its own plan.
    assert_eq!(frames(&["--frame", "3-4", "--plan", "--plan-file", "p.%d.plan"]).code, Some(0));
    let planned = frames(&["--frame", "3-4", "--plan-file", "p.%d.plan", "--exr", "q.%d.exr"]);
    assert!(planned.code == Some(0) && bytes("q.4.exr") == fourth, "{}", planned.stderr);
    assert_eq!(frames(&["--check", "--frame", "1-3"]).stderr.matches("is a valid scene").count(), 3);
    for (arguments, message) in [
        (
            &["--exr", "one.exr"][..],
            "one.exr would be written by every frame\nhelp: put the frame number into the name: one.%04d.exr",
        ),
        (&["--exr", "-"], "- would be written by every frame"),
        (
            &["--png", "a/one.png"],
            "a/one.png would be written by every frame\nhelp: put the frame number into the name: a/one.%04d.png",
        ),
        (&["--report", "one.json"], "one.json would be written by every frame"),
        (&["--progress", "openjd"], "--progress reports a single frame"),
        (
            &["--plan-file", "p.plan"],
            "p.plan would be written by every frame\nhelp: put the frame number into the name: p.%04d.plan",
        ),
    ] {
        let refused = frames(&[&["--frame", "1-2"], arguments].concat());
        let printed = refused.stdout + &refused.stderr;
        assert!(refused.code == Some(2) && printed.contains(message), "{arguments:?}: {printed}");
    }
}

#[test]
fn the_image_records_what_was_set() {
    let folder = folder();
    let sets = ["--set", "film.width=5", "--set", "object.ball.material=gold"];
    assert_eq!(render(&folder, &["scene.toml"].into_iter().chain(sets).collect::<Vec<_>>()).code, Some(0));
    let printed = render(&folder, &["info", "scene.exr"]).stdout;
    assert!(printed.contains("--set film.width=5 --set object.ball.material=gold\n"), "{printed}");
    assert_eq!(render(&folder, &["scene.toml"]).code, Some(0));
    assert!(!render(&folder, &["info", "scene.exr"]).stdout.contains("render/set"));
}

#[test]
fn completions_and_the_manual_page_know_every_flag_and_command() {
    let folder = Folder::new();
    let help = render(&folder, &["--help"]).stdout;
    let flags: Vec<&str> = help.split_whitespace().filter(|word| word.starts_with("--")).collect();
    let words = |text: &str| text.replace("\\-", "-");
    let page = render(&folder, &["man"]);
    assert!(page.code == Some(0) && page.stdout.contains(".TH render 1"), "{}", page.stderr);
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = render(&folder, &["completions", shell]);
        assert_eq!((script.code, &*script.stderr), (Some(0), ""));
        for command in ["catalog", "info", "view", "diff", "merge", "completions", "man"] {
            assert!(script.stdout.contains(command) && page.stdout.contains(command), "{shell}: {command}");
        }
        let known = words(&script.stdout);
        assert!(
            ["set", "json", "quiet", "frame", "spectral", "progress"].iter().all(|flag| known.contains(flag)),
            "{shell}"
        );
    }
    let page = words(&page.stdout);
    // There are no other pages, and no command `help`.
    assert!(page.contains("\n.SS \"render merge\"") && !page.contains("render-merge") && !page.contains("render-help"));
    assert!(page.contains("\n.TP\n\\fBrender info prism.exr\\fR\nlist what an image holds\n"), "{page}");
    assert!(["--set", "--json", "--quiet", "--frame"].iter().all(|flag| flags.contains(flag) && page.contains(flag)));
    let wrong = render(&folder, &["completions", "fsh"]);
    assert!(wrong.code == Some(2) && wrong.stderr.contains("'fish'"), "{}", wrong.stderr);
}
