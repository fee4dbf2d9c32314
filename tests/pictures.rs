//! Pictures of simulated runs by the command: the SVG file, and the animation with its time, its size and its looks.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

const BALLOON: &str = "examples/balloon.hyped";
const SCRIPT: &str = "examples/inputs/balloon.inputs";

/// A folder of its own for each test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pictures").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The exit code and all output of `hypedc sim`.
fn sim(arguments: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_hypedc")).arg("sim").args(arguments).output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    (output.status.code().unwrap(), String::from_utf8(text).unwrap())
}

/// A decoded animation: its pictures as a whole each, and how long each is shown, in hundredths of a second.
struct Animation {
    size: (usize, usize),
    pictures: Vec<(Vec<[u8; 3]>, u64)>,
}

fn animation(path: &Path) -> Animation {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(File::open(path).unwrap()).unwrap();
    let size = (usize::from(decoder.width()), usize::from(decoder.height()));
    let mut canvas = vec![[0; 3]; size.0 * size.1];
    let mut pictures = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        for (index, pixel) in frame.buffer.chunks_exact(4).enumerate() {
            let (x, y) = (index % usize::from(frame.width), index / usize::from(frame.width));
            if pixel[3] > 0 {
                canvas[(usize::from(frame.top) + y) * size.0 + usize::from(frame.left) + x] =
                    [pixel[0], pixel[1], pixel[2]];
            }
        }
        pictures.push((canvas.clone(), u64::from(frame.delay)));
    }
    Animation { size, pictures }
}

#[test]
fn an_animation_takes_as_long_as_the_run() {
    let folder = folder("time");
    let path = folder.join("balloon.gif");
    let path = path.to_str().unwrap();
    let (code, _) = sim(&[BALLOON, "--inputs-file", SCRIPT, "--gif", path]);
    assert_eq!(code, 0);
    let shown = animation(Path::new(path));
    // 340 steps of 1/60 s, and the last picture for 1.5 s.
    assert_eq!(shown.pictures.iter().map(|(_, delay)| delay).sum::<u64>(), 567 + 150);
    assert!(shown.pictures.len() > 60, "{}", shown.pictures.len());
    assert!(shown.pictures.windows(2).all(|pair| pair[0].0 != pair[1].0));
    let bytes = fs::read(path).unwrap();
    sim(&[BALLOON, "--inputs-file", SCRIPT, "--gif", path]);
    assert!(bytes == fs::read(path).unwrap(), "the same run gives the same bytes");
    // Fewer pictures for the same time.
    let (code, _) = sim(&[BALLOON, "--inputs-file", SCRIPT, "--gif", path, "--scale", "1", "--every", "10", "--dark"]);
    let small = animation(Path::new(path));
    assert_eq!((code, small.pictures.iter().map(|(_, delay)| delay).sum::<u64>()), (0, 567 + 150));
    assert!(small.pictures.len() <= 36, "{}", small.pictures.len());
    assert!(small.size.0 < shown.size.0, "{:?} and {:?}", small.size, shown.size);
}

#[test]
fn a_run_is_drawn_with_its_goals() {
    let folder = folder("svg");
    let path = folder.join("balloon.svg");
    let path = path.to_str().unwrap();
    let (code, _) = sim(&[BALLOON, "--inputs-file", SCRIPT, "--svg", path]);
    let svg = fs::read_to_string(path).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let texts: Vec<&str> = document.descendants().filter_map(|node| node.text()).collect();
    assert_eq!(code, 0);
    for words in ["Valley: a run", "340 steps, 5.67 s", "over: step 340, 5.67 s", "goal reached"] {
        assert!(texts.contains(&words), "no `{words}` in {texts:?}");
    }
    assert!(svg.contains("class=\"yes\""), "the run is as expected");
    let (code, _) = sim(&[BALLOON, "--inputs", "-*9", "--svg", path, "--expect", "over"]);
    let svg = fs::read_to_string(path).unwrap();
    assert!(code == 1 && svg.contains("class=\"no\"") && !svg.contains("class=\"reached\""));
}

/// A program with a picture of noise that moves; its sides in pixels.
const SIDE: u32 = 200;

fn noisy(folder: &Path) -> String {
    let mut state = 7u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    let pixels: Vec<u8> = (0..SIDE * SIDE).flat_map(|_| [noise() & 0xe0, noise() & 0xe0, 0xff, 0xff]).collect();
    let file = File::create(folder.join("noise.png")).unwrap();
    let mut encoder = png::Encoder::new(file, SIDE, SIDE);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
    let text = "entity Cloud { look \"noise.png\"; collider cloud: rect(0, 0, 200, 200); x' = 60 }
        entity Hero { look #123456; collider body: rect(0, 0, 10, 10) }
        world Sky {
            look floor: #fedcba
            collide body with floor: block
            space main {
                bounds rect(0, 0, 600, 300)
                rect floor (0, 0, 600, 20)
                place cloud: Cloud at (0, 50)
                place hero: Hero at (300, 20)
            }
            player 1: hero
        }\n";
    let path = folder.join("sky.hyped");
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_string()
}

#[test]
fn a_file_that_would_be_too_large_is_refused() {
    let folder = folder("size");
    let program = noisy(&folder);
    let path = folder.join("sky.gif");
    let gif = path.to_str().unwrap();
    let (code, text) = sim(&[&program, "--frames", "200", "--gif", gif, "--max-size", "1", "--scale", "1"]);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("would have more than 1 MiB at step") && text.contains("`--every`"), "{text}");
    assert!(!path.exists());
    let (code, text) = sim(&[&program, "--frames", "10", "--gif", gif, "--max-size", "1", "--scale", "1"]);
    assert!(code == 0 && path.exists(), "{text}");
}

#[test]
fn looks_are_seen() {
    let folder = folder("looks");
    let program = noisy(&folder);
    let (gif, svg) = (folder.join("sky.gif"), folder.join("sky.svg"));
    let arguments = [&program, "--frames", "4", "--gif", gif.to_str().unwrap(), "--svg", svg.to_str().unwrap()];
    let (code, text) = sim(&arguments);
    assert_eq!(code, 0, "{text}");
    let shown = animation(&gif);
    let count = |color: [u8; 3]| shown.pictures[0].0.iter().filter(|pixel| **pixel == color).count();
    assert!(count([0x12, 0x34, 0x56]) > 20 && count([0xfe, 0xdc, 0xba]) > 1000);
    let noise = shown.pictures[0].0.iter().filter(|pixel| pixel[2] == 0xff).count();
    assert!(noise > (SIDE * SIDE / 2) as usize, "{noise}");
    let drawn = fs::read_to_string(&svg).unwrap();
    assert!(
        drawn.contains("data:image/png;base64,") && drawn.contains("fill:#123456") && drawn.contains("fill:#fedcba")
    );
    roxmltree::Document::parse(&drawn).unwrap();
    // A picture that is not there.
    fs::remove_file(folder.join("noise.png")).unwrap();
    let (code, text) = sim(&arguments);
    assert!(code == 2 && text.contains("cannot show") && text.contains("noise.png"), "{text}");
}

/// In a room larger than the picture the camera follows the first player.
#[test]
fn the_camera_follows_the_first_player() {
    let folder = folder("camera");
    let path = folder.join("walk.hyped");
    let text = "entity Hero { look #ff0000; axis horizontal; param speed = 300; collider body: rect(0, 0, 16, 16); x' = speed * horizontal }
        world Hall {
            collide body with floor: block
            space main { bounds rect(0, 0, 4000, 200); rect floor (0, 0, 4000, 20); rect pole (0, 20, 9, 60); rect pole (700, 20, 9, 60)
                rect pole (1200, 20, 9, 60); rect pole (1700, 20, 9, 60); place hero: Hero at (20, 20) }
            player 1: hero
        }";
    fs::write(&path, text).unwrap();
    let gif = folder.join("walk.gif");
    let (code, text) =
        sim(&[path.to_str().unwrap(), "--inputs", "right*400", "--gif", gif.to_str().unwrap(), "--every", "40"]);
    assert_eq!(code, 0, "{text}");
    let shown = animation(&gif);
    assert!(shown.size.0 == 640 && shown.size.1 < 200, "{:?}", shown.size);
    // Poles go by.
    assert!(shown.pictures.len() > 5, "{}", shown.pictures.len());
    for (picture, _) in &shown.pictures {
        assert!(picture.iter().filter(|pixel| **pixel == [0xff, 0, 0]).count() > 100, "the player is not seen");
    }
}
