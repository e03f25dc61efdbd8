//! Streams that nobody reads, and the places where an image is written: the image is made whatever happens to the
//! messages.

#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;

use crate::support::pictures::read_png;
use crate::support::run::{Folder, render};

const SCENE: &str = r#"
camera = { position = [0, 1, 6], look_at = [0, 1, 0], vertical_fov = 35 }
film = { width = 6, height = 4 }
render.samples = 1
material.white.diffuse = { reflectance = 0.7 }

[[object]]
shape.sphere = { center = [0, 1, 0], radius = 1 }
material = "white"

[[light]]
environment = { radiance = 1 }
"#;

fn folder() -> Folder {
    Folder::with("ball.toml", SCENE)
}

/// Runs a shell line in which `$RENDER` is the command. Returns its exit code, stdout and stderr.
fn shell(folder: &Folder, line: &str) -> (Option<i32>, String, String) {
    let mut command = Command::new("sh");
    command.env("RENDER", env!("CARGO_BIN_EXE_render")).current_dir(folder.path()).args(["-c", line]);
    let output = command.output().expect("there is a shell");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("messages are UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn is_image(path: &Path) -> bool {
    fs::read(path).expect("the image is there").starts_with(&[0x76, 0x2f, 0x31, 0x01])
}

/// The limit is one of address space, below the size of the film.
#[cfg(target_os = "linux")]
#[test]
fn a_film_that_does_not_fit_in_memory_is_refused_and_planned_all_the_same() {
    let folder = folder();
    let run = |flag: &str| {
        let size = "--set film.width=16384 --set film.height=16384 --threads 1";
        shell(&folder, &format!("ulimit -v 4000000; $RENDER {flag} ball.toml {size}"))
    };
    let (code, plan, _) = run("--plan");
    assert_eq!(code, Some(0));
    assert!(plan.contains("\nfilm: 16384 x 16384 pixels take 19.3 GB of memory\n"), "{plan}");
    let (code, _, stderr) = run("--exr");
    let expected = "error: cannot keep the film in memory, 19.3 GB: not enough memory is free; --crop and --shard \
                    render a part of the image\n";
    assert_eq!((code, &*stderr), (Some(1), expected));
    assert_eq!(folder.file_names(), ["ball.toml"]);
}

#[test]
fn an_image_is_written_although_stderr_cannot_be() {
    for lost in ["2>/dev/full", "2>&-", "2>&- 1>&- <&-", "2>/dev/full >/dev/full", "2>&1 | true"] {
        let folder = folder();
        let (code, out, stderr) = shell(&folder, &format!("$RENDER --exr ball.toml --png look.png {lost}"));
        assert_eq!((code, &*out, &*stderr), (Some(0), "", ""), "{lost}");
        assert_eq!(folder.file_names(), ["ball.exr", "ball.toml", "look.png"], "{lost}");
        assert!(is_image(&folder.path_of("ball.exr")), "{lost}");
        // No message ended up in the picture.
        assert_eq!(read_png(&folder.path_of("look.png")).pixels.len(), 6 * 4, "{lost}");
    }
}

#[test]
fn a_reader_of_stderr_that_has_gone_loses_no_image() {
    let folder = folder();
    let line = "{ sleep 0.3; $RENDER --exr ball.toml; echo $? >code; } 2>&1 | true; sleep 0.3; \
                while [ ! -s code ]; do sleep 0.1; done";
    shell(&folder, line);
    assert_eq!(fs::read_to_string(folder.path_of("code")).expect("it ended"), "0\n");
    assert!(is_image(&folder.path_of("ball.exr")));
}

#[test]
fn a_refusal_that_cannot_be_printed_keeps_its_exit_code() {
    let folder = folder();
    folder.write("bad.toml", "camera = 5\n");
    for (arguments, expected) in [
        ("bad.toml", 2),
        ("ball.toml --samples 0", 2),
        ("ball.toml --exr ball.toml/a.exr", 1),
        ("catalog no-such-thing", 2),
        ("ball.toml --exr /dev/null", 2),
    ] {
        for lost in ["2>/dev/full", "2>&-"] {
            assert_eq!(shell(&folder, &format!("$RENDER {arguments} {lost}")).0, Some(expected), "{arguments} {lost}");
        }
    }
}

#[test]
fn an_answer_that_nobody_reads_to_the_end_is_no_failure() {
    let folder = folder();
    for question in ["--plan ball.toml", "catalog", "--help", "catalog --help", "--version"] {
        // The reader is gone before the first word.
        let line = format!("{{ sleep 0.2; $RENDER {question}; echo $? >code; }} | true");
        let (_, _, stderr) = shell(&folder, &format!("{line}; while [ ! -s code ]; do sleep 0.1; done"));
        let code = fs::read_to_string(folder.path_of("code")).expect("it ended");
        assert_eq!((&*code, &*stderr), ("0\n", ""), "{question}");
        fs::remove_file(folder.path_of("code")).expect("it can be removed");
        assert_eq!(shell(&folder, &format!("$RENDER {question} >&-")).0, Some(0), "{question}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_answer_that_cannot_be_written_is_a_failure() {
    let folder = folder();
    for question in ["--plan ball.toml", "catalog", "--help", "catalog --help", "--version"] {
        let (code, _, stderr) = shell(&folder, &format!("$RENDER {question} >/dev/full"));
        let reason = "error: cannot write the answer to stdout: the disk is full\n";
        assert_eq!((code, &*stderr), (Some(1), reason), "{question}");
        assert_eq!(shell(&folder, &format!("$RENDER {question} >/dev/full 2>/dev/full")).0, Some(1), "{question}");
    }
    // The image is made and kept nevertheless.
    for protocol in ["--json", "--progress openjd"] {
        let (code, _, stderr) = shell(&folder, &format!("$RENDER --exr ball.toml {protocol} >/dev/full"));
        let reason = "error: cannot write all output to stdout: the disk is full\n";
        assert!(code == Some(1) && stderr.ends_with(reason), "{protocol}: {stderr}");
        assert!(is_image(&folder.path_of("ball.exr")), "{protocol}");
        fs::remove_file(folder.path_of("ball.exr")).expect("it is there");
    }
    // A program that reads from there cannot be told why.
    for question in ["--json --plan ball.toml", "--json --check ball.toml"] {
        assert_eq!(shell(&folder, &format!("$RENDER {question} >/dev/full")).0, Some(1), "{question}");
    }
}

#[test]
fn an_output_that_is_a_link_is_written_through() {
    for (before, target) in [(Some("an older image"), "store/a.exr"), (None, "store/new.exr"), (None, "new/a.exr")] {
        let folder = folder();
        fs::create_dir(folder.path_of("store")).expect("folders can be made");
        before.inspect(|text| folder.write(target, text));
        // A link to a link. Each is relative to its own folder.
        symlink("links/second.exr", folder.path_of("first.exr")).expect("links can be made");
        fs::create_dir(folder.path_of("links")).expect("folders can be made");
        symlink(Path::new("..").join(target), folder.path_of("links/second.exr")).expect("links can be made");
        let answer = render(&folder, &["ball.toml", "--exr", "first.exr"]);
        assert_eq!(answer.code, Some(0), "{}", answer.stderr);
        assert!(folder.path_of("first.exr").is_symlink() && folder.path_of("links/second.exr").is_symlink());
        assert!(is_image(&folder.path_of(target)), "{target}");
    }
}

#[test]
fn a_link_that_leads_nowhere_is_refused_before_anything_is_rendered() {
    let folder = folder();
    symlink("b.exr", folder.path_of("a.exr")).expect("links can be made");
    symlink("a.exr", folder.path_of("b.exr")).expect("links can be made");
    symlink(".", folder.path_of("here.exr")).expect("links can be made");
    symlink("ball.toml", folder.path_of("scene.exr")).expect("links can be made");
    for (output, code, stderr) in [
        ("a.exr", 1, "error: cannot write a.exr: it is a link that leads back to itself\n"),
        ("here.exr", 1, "error: cannot write here.exr: it is a folder\n"),
    ] {
        let answer = render(&folder, &["ball.toml", "--exr", output]);
        assert_eq!((answer.code, &*answer.stdout, &*answer.stderr), (Some(code), "", stderr));
    }
    let answer = render(&folder, &["ball.toml", "--exr", "scene.exr"]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.stderr.ends_with("scene.exr is the scene itself\nhelp: name another file\n"), "{}", answer.stderr);
    assert_eq!(folder.file_names(), ["a.exr", "b.exr", "ball.toml", "here.exr", "scene.exr"]);
    assert_eq!(fs::read_to_string(folder.path_of("ball.toml")).expect("the scene is there"), SCENE);
}

#[test]
fn a_render_that_is_refused_leaves_no_folders() {
    let folder = folder();
    let new = |more: &[&str]| render(&folder, &[&["ball.toml", "--exr", "new/deep/a.exr"], more].concat());
    for refused in [&["--png", "ball.toml/a.png"][..], &["--plan-file", "no.plan", "--png", "new/other/a.png"]] {
        let answer = new(refused);
        assert!(matches!(answer.code, Some(1 | 2)), "{}", answer.stderr);
        assert_eq!(folder.file_names(), ["ball.toml"]);
    }
    // Folders that are not empty are kept.
    folder.write("new/notes", "of today");
    assert_eq!(new(&["--png", "ball.toml/a.png"]).code, Some(1));
    assert!(!folder.path_of("new/deep").exists() && folder.path_of("new/notes").exists());
    assert_eq!(new(&[]).code, Some(0));
    assert!(is_image(&folder.path_of("new/deep/a.exr")));
}

/// Another render that is refused may have removed the folder.
#[test]
fn a_folder_that_is_gone_when_the_image_is_written_is_made_again() {
    let folder = folder();
    let path = folder.path_of("gone/a.exr");
    abbe::film::check_writable(&path).expect("the folder can be made");
    fs::remove_dir(folder.path_of("gone")).expect("it is empty");
    abbe::film::replace_file(&path, b"an image").expect("the folder can be made");
    assert_eq!(folder.read("gone/a.exr"), b"an image");
}

#[test]
fn permissions_of_an_image_survive_and_a_protected_one_is_left_alone() {
    let folder = folder();
    let path = folder.path_of("ball.exr");
    folder.write("ball.exr", "an older image");
    let mode = |mode| fs::set_permissions(&path, Permissions::from_mode(mode)).expect("permissions can be set");
    mode(0o640);
    assert_eq!(render(&folder, &["ball.toml"]).code, Some(0));
    assert!(is_image(&path));
    assert_eq!(fs::metadata(&path).expect("it is there").mode() & 0o777, 0o640);
    folder.write("ball.exr", "an older image");
    mode(0o444);
    let answer = render(&folder, &["ball.toml"]);
    assert_eq!((answer.code, &*answer.stderr), (Some(1), "error: cannot write ball.exr: permission is denied\n"));
    assert_eq!(fs::read(&path).expect("it is there"), b"an older image");
    assert_eq!(folder.file_names(), ["ball.exr", "ball.toml"]);
}

#[test]
fn another_name_of_the_same_file_keeps_the_older_image() {
    let folder = folder();
    folder.write("ball.exr", "an older image");
    fs::hard_link(folder.path_of("ball.exr"), folder.path_of("kept.exr")).expect("links can be made");
    assert_eq!(render(&folder, &["ball.toml"]).code, Some(0));
    assert!(is_image(&folder.path_of("ball.exr")));
    assert_eq!(folder.read("kept.exr"), b"an older image");
}

#[test]
fn the_longest_names_can_be_written() {
    let (folder, name) = (folder(), format!("{}.exr", "a".repeat(251)));
    let answer = render(&folder, &["ball.toml", "--exr", &name]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    assert_eq!(folder.file_names(), [&*name, "ball.toml"]);
    let answer = render(&folder, &["ball.toml", "--exr", &format!("a{name}")]);
    assert_eq!((answer.code, folder.file_names().len()), (Some(1), 2), "{}", answer.stderr);
}

#[test]
fn what_is_no_file_is_written_to_as_it_is() {
    let folder = folder();
    for (link, device) in [("null.exr", "/dev/null"), ("stdout.exr", "/dev/stdout")] {
        symlink(device, folder.path_of(link)).expect("links can be made");
    }
    let (code, out, stderr) = shell(&folder, "$RENDER ball.toml --exr null.exr | cat");
    assert_eq!((code, &*out), (Some(0), ""), "{stderr}");
    let (_, out, stderr) = shell(&folder, "$RENDER ball.toml --exr stdout.exr | head -c 4 | od -An -tx1");
    assert_eq!(out.trim(), "76 2f 31 01", "{stderr}");
    let (_, out, stderr) =
        shell(&folder, "mkfifo pipe.exr; $RENDER ball.toml --exr pipe.exr & head -c 4 pipe.exr | od -An -tx1; wait");
    assert_eq!(out.trim(), "76 2f 31 01", "{stderr}");
    assert_eq!(folder.file_names(), ["ball.toml", "null.exr", "pipe.exr", "stdout.exr"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_that_takes_no_more_is_a_failure() {
    let folder = folder();
    symlink("/dev/full", folder.path_of("full.exr")).expect("links can be made");
    let answer = render(&folder, &["ball.toml", "--exr", "full.exr"]);
    assert_eq!(answer.code, Some(1));
    assert!(answer.stderr.ends_with("error: cannot write full.exr: the disk is full\n"), "{}", answer.stderr);
}

/// An output that cannot be written does not prevent the other outputs or the checkpoint.
#[cfg(target_os = "linux")]
#[test]
fn what_can_be_written_is_written() {
    let files = ["full.exr", "full.png", "full.json", "a.exr", "a.png", "a.json"];
    for failing in 0..3 {
        let folder = folder();
        for name in &files[..3] {
            symlink("/dev/full", folder.path_of(name)).expect("links can be made");
        }
        let [exr, png, report] = [0, 1, 2].map(|i| files[if i == failing { i } else { 3 + i }]);
        let words = ["ball.toml", "--exr", exr, "--png", png, "--report", report, "--checkpoint", "60s"];
        let answer = render(&folder, &words);
        assert!(answer.stderr.ends_with(&format!("error: cannot write {}: the disk is full\n", files[failing])));
        assert_eq!(answer.code, Some(1), "{}", answer.stderr);
        let written: Vec<&str> = files[3..].iter().copied().filter(|name| folder.path_of(name).is_file()).collect();
        let stderr: Vec<&str> = answer.stderr.lines().filter_map(|line| line.strip_prefix("wrote ")).collect();
        assert_eq!((written.len(), &stderr), (2, &written), "{}", answer.stderr);
        // Only the missing file is left to be written.
        fs::remove_file(folder.path_of(files[failing])).expect("it is there");
        let resumed = render(&folder, &[&words[..], &["--resume"]].concat());
        assert!(resumed.code == Some(0) && !resumed.stderr.contains("going on from"), "{}", resumed.stderr);
        assert!(folder.path_of(files[failing]).is_file());
    }
}

/// Creates a scene that includes a file, reads a mesh and a spectrum, and is lit by an image.
fn folder_of_a_whole_scene() -> Folder {
    let folder = Folder::with("light.toml", "[[light]]\nenvironment = { radiance = { image = \"sky.hdr\" } }\n");
    folder.write("cup.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    folder.write("gray.csv", "400, 0.5\n700, 0.5\n");
    folder.write("main.toml", "include = [\"light.toml\"]\ncamera = { position = [0, 0, 6], look_at = [0, 0, 0], vertical_fov = 35 }\n\
        film = { width = 6, height = 4 }\nrender.samples = 1\nmaterial.gray.diffuse = { reflectance = { file = \"gray.csv\" } }\n\
        [[object]]\nshape.mesh = { file = \"cup.obj\" }\nmaterial = \"gray\"\n");
    let mut sky = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n".to_vec();
    sky.extend([[128, 128, 128, 129]; 8].concat());
    folder.write("sky.hdr", sky);
    folder
}

#[test]
fn no_output_takes_the_place_of_what_the_scene_is_read_from() {
    let folder = folder_of_a_whole_scene();
    fs::create_dir(folder.path_of("other")).expect("the folder takes folders");
    symlink("../cup.obj", folder.path_of("other/link.png")).expect("the folder takes links");
    let before = |name: &str| folder.read(name);
    let names = ["cup.obj", "gray.csv", "light.toml", "main.toml", "sky.hdr"];
    let files = names.map(before);
    for (arguments, name) in [
        ("--exr sky.hdr", ""),
        ("--report cup.obj", "cup.obj"),
        ("--report light.toml", "light.toml"),
        ("--report ./gray.csv", "./gray.csv"),
        ("--report sky.hdr", "sky.hdr"),
        ("--png other/link.png", "other/link.png"),
        ("--plan --plan-file sky.hdr", "sky.hdr"),
    ] {
        let words: Vec<&str> = ["main.toml"].into_iter().chain(arguments.split(' ')).collect();
        let answer = render(&folder, &words);
        assert_eq!(answer.code, Some(2), "{arguments}: {}", answer.stderr);
        if !name.is_empty() {
            let message = format!("error: {name} is a file that the scene reads\nhelp: name another file\n");
            assert_eq!(answer.stderr, message, "{arguments}");
        }
        assert_eq!(names.map(before), files, "{arguments}");
    }
}

#[test]
fn no_text_file_takes_the_place_of_an_image() {
    let folder = folder();
    folder.write("old.exr", "an image of last week");
    for (arguments, message, help) in [
        (
            "--report old.exr",
            "--report does not write an image, but old.exr has the name of one",
            "--report frame.json",
        ),
        ("--report a.PNG", "--report does not write an image, but a.PNG has the name of one", "--report frame.json"),
        ("--report -", "--report writes a file, and - is standard output", "--report frame.json"),
        (
            "--plan --plan-file old.exr",
            "--plan-file does not write an image, but old.exr has the name of one",
            "--plan-file frame.plan",
        ),
        ("--plan --plan-file -", "--plan-file writes a file, and - is standard output", "--plan-file frame.plan"),
    ] {
        let words: Vec<&str> = ["ball.toml"].into_iter().chain(arguments.split(' ')).collect();
        let answer = render(&folder, &words);
        let message = format!("error: {message}\nhelp: for instance: {help}\n");
        assert_eq!((answer.code, answer.stderr), (Some(2), message), "{arguments}");
        assert_eq!(folder.file_names(), ["ball.toml", "old.exr"], "{arguments}");
    }
    assert_eq!(folder.read("old.exr"), b"an image of last week");
}

#[test]
fn no_two_outputs_are_one_file() {
    let folder = folder();
    fs::create_dir(folder.path_of("other")).expect("the folder takes folders");
    for (arguments, name) in [
        ("--exr a.exr --report a.exr", "a.exr"),
        ("--exr a.exr --report other/../a.exr", "other/../a.exr"),
        ("--png a.png --report a.png", "a.png"),
        ("--exr a.exr --spectral --report a.spectral.exr", "a.spectral.exr"),
        ("--exr a.exr --checkpoint 1h --report a.checkpoint", "a.checkpoint"),
    ] {
        let words: Vec<&str> = ["ball.toml"].into_iter().chain(arguments.split(' ')).collect();
        let answer = render(&folder, &words);
        let message = format!("error: {name} would be written twice\nhelp: name another file\n");
        assert_eq!((answer.code, answer.stderr), (Some(2), message), "{arguments}");
        assert_eq!(folder.file_names(), ["ball.toml", "other"], "{arguments}");
    }
}
