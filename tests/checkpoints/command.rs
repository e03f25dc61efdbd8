//! Messages of the command about checkpoints and parts, and the files that it leaves alone.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, SystemTime};

use super::GLASS;
use crate::support::run::{Answer, Folder, render};

fn folder() -> Folder {
    Folder::with("s.toml", GLASS)
}

/// Runs `render` with arguments that are separated by blanks.
fn run(folder: &Folder, words: &str) -> Answer {
    render(folder, &words.split(' ').collect::<Vec<_>>())
}

/// Returns the rest of stderr from the first occurrence of a word.
fn stderr_from<'a>(answer: &'a Answer, word: &str) -> &'a str {
    answer.stderr.find(word).map_or(&*answer.stderr, |at| &answer.stderr[at..]).trim_end()
}

fn assert_refusal(folder: &Folder, words: &str, message: &str) {
    let answer = run(folder, words);
    assert_eq!((answer.code, stderr_from(&answer, "error:")), (Some(2), message), "{words}");
}

fn run_ok(folder: &Folder, words: &str) -> Answer {
    let answer = run(folder, words);
    assert_eq!(answer.code, Some(0), "{words}: {}", answer.stderr);
    answer
}

fn modified_time(folder: &Folder, name: &str) -> SystemTime {
    fs::metadata(folder.path_of(name)).and_then(|found| found.modified()).expect("it was written")
}

#[test]
fn resuming_a_finished_render_says_so_and_rewrites_nothing() {
    let folder = folder();
    let begun = run_ok(&folder, "s.toml --resume");
    assert!(
        begun.stderr.contains("there is no s.checkpoint yet: the render starts from the beginning\n"),
        "{}",
        begun.stderr
    );
    assert_eq!(folder.file_names(), ["s.checkpoint", "s.exr", "s.toml"]);
    let times = ["s.checkpoint", "s.exr"].map(|name| modified_time(&folder, name));
    for (words, message) in [
        (
            "s.toml --resume",
            "s.checkpoint has all samples that are needed, and the image is written: nothing is left to do",
        ),
        (
            "s.toml --resume --checkpoint 1h",
            "s.checkpoint has all samples that are needed, and the image is written: nothing is left to do",
        ),
    ] {
        // The command makes no plan for this.
        assert_eq!(run_ok(&folder, words).stderr, format!("{message}\n"), "{words}");
    }
    assert_eq!(["s.checkpoint", "s.exr"].map(|name| modified_time(&folder, name)), times);
    // An image that differs from the written one is made again, and so are other files that are now asked for.
    let image = folder.read("s.exr");
    folder.write("s.exr", "another image");
    run_ok(&folder, "s.toml --resume");
    assert!(folder.read("s.exr") == image);
    run_ok(&folder, "s.toml --resume --exr s.exr --png s.png --report s.json");
    assert_eq!(folder.file_names(), ["s.checkpoint", "s.exr", "s.json", "s.png", "s.toml"]);
    // A different exposure makes a different picture.
    let picture = folder.read("s.png");
    run_ok(&folder, "s.toml --resume --exr s.exr --png s.png --exposure 2");
    assert!(folder.read("s.png") != picture && folder.read("s.exr") == image);
    let arguments = "s.toml --resume --exr s.exr --png s.png --exposure 2";
    assert!(run_ok(&folder, arguments).stderr.contains("nothing is left to do"));
    // An image that was lost is written again.
    fs::remove_file(folder.path_of("s.exr")).expect("it is there");
    run_ok(&folder, "s.toml --resume");
    assert!(folder.read("s.exr") == image);
    assert_refusal(
        &folder,
        "s.toml --checkpoint 1h",
        "error: s.checkpoint already exists from an earlier run\nhelp: add --resume to go on from it, or delete it to start over",
    );
}

#[test]
fn a_checkpoint_of_something_else_is_refused_in_one_line_that_says_what_differs() {
    let folder = folder();
    run_ok(&folder, "s.toml --resume --samples 4");
    let begin_anew = "help: delete it to start over, or name another image";
    for (flags, difference) in [
        ("--seed 4", "its seed is 3, not 4"),
        ("--crop 0,0,8,8", "its crop is none, not 0,0,8,8"),
        ("--overscan 2", "its overscan is 0,0,0,0, not 2,2,2,2"),
        ("--layers N", "its list of layers is empty, not N"),
        ("--spectral", "its number of spectral bands is 0, not 81"),
    ] {
        let message = format!("error: cannot go on from s.checkpoint: {difference}\n{begin_anew}");
        assert_refusal(&folder, &format!("s.toml --resume --samples 4 {flags}"), &message);
    }
    folder.write("s.toml", GLASS.replace("index = 1.5", "index = 1.6"));
    let difference = "it was made from another scene, or from this one before it was changed";
    let message = format!("error: cannot go on from s.checkpoint: {difference}\n{begin_anew}");
    assert_refusal(&folder, "s.toml --resume --samples 4", &message);
    #[cfg(unix)]
    {
        // A pipe that nobody writes to.
        let pipe = folder.path_of("s.checkpoint");
        fs::remove_file(&pipe).expect("it is there");
        assert!(Command::new("mkfifo").arg(&pipe).status().expect("there is mkfifo").success());
        let message = "error: cannot go on from s.checkpoint: it is not a checkpoint\nhelp: name another image, or move that file away";
        assert_refusal(&folder, "s.toml --resume", message);
        fs::remove_file(&pipe).expect("it is there");
    }
    folder.write("s.checkpoint", "something else");
    assert_refusal(
        &folder,
        "s.toml --resume",
        "error: cannot go on from s.checkpoint: it is not a checkpoint\nhelp: name another image, or move that file away",
    );
    assert_refusal(
        &folder,
        "s.toml --checkpoint 1h",
        "error: s.checkpoint would be overwritten, but it is not a checkpoint\n\
         help: name another image, or move that file away",
    );
    assert_eq!(folder.read("s.checkpoint"), b"something else");
}

#[test]
fn parts_that_do_not_make_one_image_are_refused_by_name() {
    let folder = folder();
    for part in ["1/2", "2/2", "1/3", "2/4294967295"] {
        run_ok(&folder, &format!("s.toml --samples 4 --exr new/folder/s.exr --shard {part}"));
    }
    run_ok(&folder, "s.toml --samples 4 --exr seed.exr --shard 2/2 --seed 8");
    // Plans without a photon map do not depend on the number of samples.
    let off = "--set render.caustics=off";
    run_ok(&folder, &format!("s.toml --samples 4 {off} --exr off.exr --shard 1/2"));
    run_ok(&folder, &format!("s.toml --samples 5 {off} --exr samples.exr --shard 2/2"));
    run_ok(&folder, "s.toml --samples 4 --exr layers.exr --shard 2/2 --layers N");
    let [one, two, third, most] =
        ["1-of-2", "2-of-2", "1-of-3", "2-of-4294967295"].map(|part| format!("new/folder/s.{part}.part"));
    let again = "help: render it again, or leave it out";
    let other = |path: &str, why: &str| format!("error: {path} does not belong to {one}: {why}\n{again}");
    folder.write("old.exr", "an image of last week");
    for (parts, message) in [
        (one.clone(), "error: part 2 of 2 is missing\nhelp: render it: --shard 2/2".into()),
        (
            most.clone(),
            "error: part 1 of 4294967295 is missing, and 4294967293 more\nhelp: render it: --shard 1/4294967295".into(),
        ),
        (third.clone(), "error: part 2 of 3 is missing, and 1 more\nhelp: render it: --shard 2/3".into()),
        (
            format!("{one} {two} {one}"),
            format!("error: {one} and {one} are both part 1 of 2\nhelp: leave one of them out"),
        ),
        (format!("{one} {two} {third}"), other(&third, "it is one of 3 parts, not of 2")),
        (format!("{one} seed.2-of-2.part"), other("seed.2-of-2.part", "its seed is 8, not 3")),
        (
            "off.1-of-2.part samples.2-of-2.part".into(),
            format!(
                "error: samples.2-of-2.part does not belong to off.1-of-2.part: it has 5 samples per pixel, not 4\n{again}"
            ),
        ),
        (format!("{one} layers.2-of-2.part"), other("layers.2-of-2.part", "its list of layers is N, not empty")),
        (
            format!("{one} s.toml"),
            "error: s.toml is not a part of an image\n\
             help: parts are made by --shard, as in render --shard 1/4 scene.toml"
                .into(),
        ),
    ] {
        assert_refusal(&folder, &format!("merge old.exr {parts}"), &message);
    }
    let missing =
        "error: there is no part new.part\nhelp: parts are made by --shard, as in render --shard 1/4 scene.toml";
    assert_refusal(&folder, &format!("merge fresh/old.exr {one} new.part"), missing);
    assert!(!folder.path_of("fresh").exists());
    assert_eq!(run(&folder, &format!("merge old.exr {one} samples.2-of-2.part")).code, Some(2));
    assert_eq!(folder.read("old.exr"), b"an image of last week");
    assert_eq!(run_ok(&folder, &format!("merge old.exr {two} {one}")).stderr, "wrote old.exr\n");
    run_ok(&folder, "s.toml --samples 4");
    assert!(folder.read("s.exr") == folder.read("old.exr"));
}

#[test]
fn a_plan_is_made_once_and_followed_and_one_of_something_else_is_refused() {
    let folder = folder();
    let arguments = "s.toml --samples 4 --layers N";
    let planned = run_ok(&folder, &format!("{arguments} --plan --plan-file new/folder/s.plan"));
    assert_eq!(planned.stderr, "wrote new/folder/s.plan\n");
    run_ok(&folder, &format!("{arguments} --exr without.exr"));
    run_ok(&folder, &format!("{arguments} --plan-file new/folder/s.plan --exr with.exr"));
    assert!(folder.read("with.exr") == folder.read("without.exr"));
    for part in ["1/2", "2/2"] {
        run_ok(&folder, &format!("{arguments} --plan-file new/folder/s.plan --exr part.exr --shard {part}"));
    }
    run_ok(&folder, "merge merged.exr part.1-of-2.part part.2-of-2.part");
    assert!(folder.read("merged.exr") == folder.read("without.exr"));
    folder.write("other.toml", GLASS.replace("index = 1.5", "index = 1.6"));
    let help = "help: make it with the same options: render --plan scene.toml --plan-file frame.plan";
    let cannot = "cannot follow new/folder/s.plan: ";
    for (words, message) in [
        (format!("{arguments} --seed 4"), format!("{cannot}its seed is 3, not 4")),
        (arguments.replace("--samples 4", "--samples 8"), format!("{cannot}its number of samples is 4, not 8")),
        (arguments.replace("N", "P"), format!("{cannot}its list of layers is N, not P")),
        (
            arguments.replace("s.toml", "other.toml"),
            format!("{cannot}it was made from another scene, or from this one before it was changed"),
        ),
    ] {
        assert_refusal(
            &folder,
            &format!("{words} --plan-file new/folder/s.plan"),
            &format!("error: {message}\n{help}"),
        );
    }
    assert_refusal(&folder, "s.toml --plan-file s.plan", &format!("error: there is no plan s.plan\n{help}"));
    assert_refusal(&folder, "s.toml --plan-file s.toml", &format!("error: s.toml is not a plan\n{help}"));
    assert_refusal(
        &folder,
        "s.toml --plan --plan-file s.toml",
        "error: s.toml is the scene itself\nhelp: name another file",
    );
    assert_eq!(folder.read("s.toml"), GLASS.as_bytes());
}

/// A plan for a scene with spectra can also be used for a picture alone, which has none.
#[test]
fn a_picture_alone_follows_the_plan_of_a_scene_with_spectra() {
    let folder = folder();
    let arguments = "s.toml --samples 4 --set film.spectral=true";
    run_ok(&folder, &format!("{arguments} --plan --plan-file s.plan"));
    run_ok(&folder, &format!("{arguments} --plan-file s.plan --png s.png"));
    assert_eq!(folder.file_names(), ["s.plan", "s.png", "s.toml"]);
}

/// Parts may have been renamed. A checkpoint that matches a new name belongs to another render.
#[test]
fn merging_deletes_the_checkpoints_of_parts_alone() {
    let folder = folder();
    for part in ["1/2", "2/2"] {
        run_ok(&folder, &format!("s.toml --samples 4 --resume --shard {part}"));
    }
    fs::rename(folder.path_of("s.1-of-2.part"), folder.path_of("s.part")).expect("any name will do");
    for other in ["s.checkpoint", "notes-of-today.checkpoint"] {
        folder.write(other, "something else");
    }
    fs::rename(folder.path_of("s.2-of-2.part"), folder.path_of("notes-of-today.part")).expect("it is there");
    run_ok(&folder, "merge --delete out.exr s.part notes-of-today.part");
    let left = "notes-of-today.checkpoint out.exr s.1-of-2.checkpoint s.2-of-2.checkpoint s.checkpoint s.toml";
    assert_eq!(folder.file_names(), left.split(' ').collect::<Vec<_>>());
}

#[test]
fn parts_of_a_scene_that_asks_for_an_error_follow_a_plan_for_parts() {
    let folder = folder();
    let arguments = "s.toml --error 0.5 --samples 64";
    run_ok(&folder, &format!("{arguments} --plan --plan-file whole.plan"));
    run_ok(&folder, &format!("{arguments} --plan --plan-file parts.plan --shard 1/2"));
    for part in ["1/2", "2/2"] {
        assert_refusal(
            &folder,
            &format!("{arguments} --plan-file whole.plan --shard {part}"),
            "error: cannot follow whole.plan: its error is 0.5, not none\n\
             help: parts take all samples, and have a plan of their own: render --plan scene.toml --shard 1/4 \
             --plan-file frame.plan",
        );
        run_ok(&folder, &format!("{arguments} --plan-file parts.plan --exr out.exr --shard {part}"));
    }
    run_ok(&folder, "merge merged.exr out.1-of-2.part out.2-of-2.part");
    run_ok(&folder, "s.toml --samples 64 --exr whole.exr");
    assert!(folder.read("merged.exr") == folder.read("whole.exr"));
}

#[test]
fn misplaced_flags_are_refused() {
    let folder = folder();
    for (words, message) in [
        ("s.toml --plan --resume", "error: --resume belongs to a render, and nothing is rendered\nhelp: leave it out"),
        (
            "s.toml --check --shard 1/2",
            "error: --shard belongs to a render, and nothing is rendered\nhelp: leave it out",
        ),
        (
            "s.toml --png a.png --shard 1/2",
            "error: --shard makes a part of an EXR, not a picture\n\
             help: leave --png out, and make a picture of the merged image",
        ),
        (
            "s.toml --png a.png --snapshot 1s",
            "error: --snapshot keeps an EXR up to date, but no EXR is written\nhelp: leave it out",
        ),
        (
            "s.toml --stamp --shard 1/2",
            "error: parts of an image record no time, so --stamp cannot be used with --shard\nhelp: leave it out",
        ),
    ] {
        assert_refusal(&folder, words, message);
    }
    for (words, part) in [
        ("s.toml --checkpoint 60", "a time is a number with a unit, such as 60s, 5m or 1h"),
        (
            "s.toml --shard 0/4",
            "a part is given as its number and the number of parts, such as 1/16, 2/16, up to 16/16",
        ),
        ("s.toml --shard 5/4", "a part is given as its number and the number of parts"),
    ] {
        let answer = run(&folder, words);
        assert!(answer.code == Some(2) && answer.stderr.contains(part), "{words}: {}", answer.stderr);
    }
    assert_eq!(folder.file_names(), ["s.toml"]);
}

/// Sends a signal to each of several commands.
#[cfg(unix)]
fn send_signal(signal: &str, to: &[&Child]) {
    let sent = Command::new("kill").arg(signal).args(to.iter().map(|child| child.id().to_string())).status();
    assert!(sent.expect("there is kill").success());
}

#[cfg(unix)]
fn wait_for(folder: &Folder, file: &str) {
    while !folder.path_of(file).exists() {
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Starts a render, waits for a file and then sends a signal twice, as `timeout` does. Returns the text on stderr and
/// the exit code.
#[cfg(unix)]
fn run_and_stop(folder: &Folder, words: &str, signal: &str, file: &str) -> (String, Option<i32>) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    command.current_dir(folder.path()).args(words.split(' ')).stderr(Stdio::piped());
    let child = command.spawn().expect("the command can be started");
    wait_for(folder, file);
    send_signal(signal, &[&child, &child]);
    let output = child.wait_with_output().expect("it ends");
    (String::from_utf8(output.stderr).expect("messages are UTF-8"), output.status.code())
}

#[cfg(unix)]
#[test]
fn a_render_that_is_told_to_stop_says_how_to_go_on_and_goes_on_to_the_same_bytes() {
    let folder = folder();
    let samples = "--samples 2000";
    run_ok(&folder, &format!("s.toml --exr whole.exr {samples}"));
    for signal in ["-INT", "-TERM"] {
        let words = format!("s.toml {samples} --threads 1 --checkpoint 20ms --snapshot 20ms");
        let (printed, code) = run_and_stop(&folder, &words, signal, "s.checkpoint");
        let message = format!(
            "stopped; s.checkpoint keeps what is done. Go on with\n  {} {words} --resume\n",
            env!("CARGO_BIN_EXE_render")
        );
        assert!(code == Some(130) && printed.ends_with(&message), "{code:?}: {printed}");
        assert_eq!(folder.file_names().iter().filter(|name| name.starts_with('.')).count(), 0);
        run_ok(&folder, &format!("s.toml {samples} --resume"));
        assert!(folder.read("s.exr") == folder.read("whole.exr"), "{signal}");
        fs::remove_file(folder.path_of("s.checkpoint")).expect("it is there");
    }
}

#[cfg(unix)]
#[test]
fn a_render_that_keeps_nothing_says_so_when_it_is_told_to_stop() {
    let folder = folder();
    for signal in ["-INT", "-TERM"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
        let words = ["s.toml", "--samples", "1000000", "--json", "--exr", "new/folder/s.exr"];
        command.current_dir(folder.path()).args(words).stdout(Stdio::piped());
        let mut child = command.spawn().expect("the command can be started");
        let mut printed = BufReader::new(child.stdout.take().expect("it is piped"));
        // The command reports its progress once a second.
        let mut line = String::new();
        while !line.contains("\"kind\":\"progress\"") {
            line.clear();
            assert!(printed.read_line(&mut line).expect("messages are UTF-8") > 0, "it renders");
        }
        send_signal(signal, &[&child]);
        let mut rest = String::new();
        printed.read_to_string(&mut rest).expect("messages are UTF-8");
        let message = "stopped; nothing of this image was kept. With --checkpoint 60s, what is done is kept";
        assert!(rest.lines().any(|line| line.contains("\"note\"") && line.contains(message)), "{rest}");
        assert_eq!(child.wait().expect("it ends").code(), Some(130));
        assert_eq!(folder.file_names(), ["s.toml"]);
    }
}

#[cfg(unix)]
#[test]
fn a_snapshot_has_its_spectra_beside_it() {
    let folder = folder();
    let (_, code) = run_and_stop(&folder, "s.toml --samples 2000 --spectral --snapshot 20ms", "-INT", "s.spectral.exr");
    assert_eq!(
        (code, folder.file_names()),
        (Some(130), ["s.exr", "s.spectral.exr", "s.toml"].map(String::from).into())
    );
    for name in ["s.exr", "s.spectral.exr"] {
        let message = run_ok(&folder, &format!("info {name}")).stdout;
        assert!(message.contains("render/complete"), "{name}: {message}");
    }
}

/// Arguments may have any encoding.
#[cfg(target_os = "linux")]
#[test]
fn the_message_on_how_to_resume_quotes_any_file_name() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = folder();
    let name = OsStr::from_bytes(b"sc\xe9ne.toml");
    fs::rename(folder.path_of("s.toml"), folder.path_of(name)).expect("any name will do");
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    command.current_dir(folder.path()).arg(name).args(["--samples", "2000", "--exr", "s.exr", "--checkpoint", "20ms"]);
    let mut child = command.stderr(Stdio::piped()).spawn().expect("the command can be started");
    wait_for(&folder, "s.checkpoint");
    send_signal("-INT", &[&child]);
    let mut printed = Vec::new();
    child.stderr.take().expect("it is piped").read_to_end(&mut printed).expect("it ends");
    let printed = String::from_utf8_lossy(&printed);
    assert!(
        child.wait().expect("it ends").code() == Some(130) && printed.contains(" $'sc\\xe9ne.toml' --samples"),
        "{printed}"
    );
}

/// Before the first sample, a signal ends the command at once, whether it writes checkpoints or not.
#[cfg(unix)]
#[test]
fn a_command_that_has_not_begun_to_render_stops_at_once() {
    let folder = folder();
    let made = Command::new("mkfifo").arg(folder.path_of("p.toml")).status().expect("there is mkfifo");
    assert!(made.success());
    for more in [&[][..], &["--checkpoint", "60s"]] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
        command.current_dir(folder.path()).args(["p.toml", "--exr", "p.exr"]).args(more).stderr(Stdio::piped());
        let child = command.spawn().expect("the command can be started");
        // The command opens the scene and waits for its text.
        let scene = fs::OpenOptions::new().write(true).open(folder.path_of("p.toml")).expect("somebody reads");
        send_signal("-TERM", &[&child]);
        let output = child.wait_with_output().expect("it ends");
        drop(scene);
        let printed = String::from_utf8(output.stderr).expect("messages are UTF-8");
        assert_eq!(
            (output.status.code(), &*printed),
            (Some(130), "stopped before anything of this image was rendered\n")
        );
    }
}

/// A limit on the file size makes a write fail, like a full disk, but ends no render.
#[cfg(unix)]
#[test]
fn a_checkpoint_that_cannot_be_written_stops_no_render_and_loses_no_file() {
    let folder = folder();
    folder.write("s.exr", "an image of last week");
    let line = "ulimit -f 4; exec \"$0\" s.toml --samples 400 --checkpoint 1ms";
    let mut shell = Command::new("sh");
    let output = shell.current_dir(folder.path()).args(["-c", line, env!("CARGO_BIN_EXE_render")]).output();
    let output = output.expect("there is a shell");
    let printed = String::from_utf8(output.stderr).expect("messages are UTF-8");
    assert!(printed.contains("warning: the render goes on, but cannot write s.checkpoint: "), "{printed}");
    assert!(printed.contains("error: cannot write s.exr: "), "{printed}");
    assert_eq!(output.status.code(), Some(1), "{printed}");
    assert_eq!(folder.file_names(), ["s.exr", "s.toml"]);
    assert_eq!(folder.read("s.exr"), b"an image of last week");
}
