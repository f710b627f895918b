//! The command line.

use std::error::Error;
use std::str::FromStr;
use std::time::Instant;

use lin_canny_record::Recording;
use lin_canny_viewer::app::{Source, Viewer};
use lin_canny_viewer::bits;
use lin_canny_viewer::headless::Headless;

type Trouble = Box<dyn Error>;

const USAGE: &str = "\
usage: lin-canny-viewer FILE | --demo N  [options]
       lin-canny-viewer --bits N

FILE is a recording (lin-canny-record); --demo 0 to 3 opens a demonstration of the web page. Opens a window. With
--screenshot or --time it needs no display and opens no window.

  --screenshot OUT.png  picture to draw
  --frame N             frame to show (default: 0)
  --size WxH            size of the picture in pixels (default: 800x600)
  --samples N           samples per pixel, 1 or 4 (default: 4)
  --no-panel            hide the panel
  --regions             show Voronoi regions
  --boxes               show the boxes of the broad phase
  --columns             show the columns of the broad phase
  --no-names            hide the ids of contacts
  --view YAW,PITCH,NEAR yaw and pitch in radians, camera distance as a fraction of the default
  --drag X,Y,DX,DY      drag of the mouse before the picture: start and displacement in pixels
  --time N              number of frames to play; prints their times
  --bits N              number of tracked queries to run; prints the hash of all results";

struct Arguments(Vec<String>);

impl Arguments {
    fn flag(&mut self, name: &str) -> bool {
        let found = self.0.iter().position(|word| word == name);
        found.map(|k| self.0.remove(k)).is_some()
    }

    fn value<T: FromStr>(&mut self, name: &str) -> Result<Option<T>, Trouble> {
        let Some(k) = self.0.iter().position(|word| word == name) else {
            return Ok(None);
        };
        self.0.remove(k);
        if k == self.0.len() {
            return Err(format!("{name} needs a value").into());
        }
        let word = self.0.remove(k);
        let parsed = word
            .parse()
            .map_err(|_| format!("{name} has an invalid value: \"{word}\""))?;
        Ok(Some(parsed))
    }

    fn numbers<const N: usize>(&mut self, name: &str) -> Result<Option<[f64; N]>, Trouble> {
        let Some(text) = self.value::<String>(name)? else {
            return Ok(None);
        };
        let parsed: Result<Vec<f64>, _> = text.split([',', 'x']).map(str::parse).collect();
        let list = parsed.ok().and_then(|list| <[f64; N]>::try_from(list).ok());
        list.map(Some)
            .ok_or_else(|| format!("{name} has an invalid value: \"{text}\" (expected {N} numbers)").into())
    }
}

/// What to open, and how to show it.
struct Options {
    demo: Option<usize>,
    file: Option<String>,
    frame: usize,
    panel: bool,
    regions: bool,
    boxes: bool,
    columns: bool,
    names: bool,
    view: Option<[f64; 3]>,
}

impl Options {
    fn open(&self, viewer: &mut Viewer) -> Result<(), Trouble> {
        match (&self.file, self.demo) {
            (Some(file), _) => viewer.open(Recording::open(file).map_err(|e| format!("{file}: {e}"))?),
            (None, Some(demo)) => viewer.open_demo(demo)?,
            (None, None) => return Err(format!("no FILE is given\n\n{USAGE}").into()),
        }
        if let Source::Recording(player) = &mut viewer.source {
            let count = player.recording.frames.len();
            if self.frame > 0 && self.frame >= count {
                return Err(format!("frame {} does not exist (expected 0..{count})", self.frame).into());
            }
            player.show(self.frame, &mut viewer.stage);
        }
        viewer.panel = self.panel;
        viewer.show.regions = self.regions;
        viewer.show.boxes = self.boxes;
        viewer.show.columns = self.columns;
        viewer.show.names = self.names;
        viewer.look_at_all();
        if let Some([yaw, pitch, near]) = self.view {
            viewer.camera.yaw = yaw;
            viewer.camera.pitch = pitch;
            viewer.camera.distance *= near;
        }
        Ok(())
    }
}

/// Runs the program.
pub fn run(words: Vec<String>) -> Result<(), Trouble> {
    let mut arguments = Arguments(words);
    if arguments.flag("-h") || arguments.flag("--help") {
        println!("{USAGE}");
        return Ok(());
    }
    if let Some(n) = arguments.value("--bits")? {
        let digest = bits::digest(n)?;
        println!("{:016x} {:?}", digest.hash, digest.classes);
        return Ok(());
    }
    let screenshot: Option<String> = arguments.value("--screenshot")?;
    let time: Option<usize> = arguments.value("--time")?;
    let [width, height] = arguments.numbers("--size")?.unwrap_or([800.0, 600.0]);
    let samples = arguments.value("--samples")?.unwrap_or(4);
    let drag: Option<[f64; 4]> = arguments.numbers("--drag")?;
    let mut options = Options {
        demo: arguments.value("--demo")?,
        file: None,
        frame: arguments.value("--frame")?.unwrap_or(0),
        panel: !arguments.flag("--no-panel"),
        regions: arguments.flag("--regions"),
        boxes: arguments.flag("--boxes"),
        columns: arguments.flag("--columns") | arguments.flag("--pencils"),
        names: !arguments.flag("--no-names"),
        view: arguments.numbers("--view")?,
    };
    if let Some(k) = arguments.0.iter().position(|word| !word.starts_with("--")) {
        options.file = Some(arguments.0.remove(k));
    }
    if let Some(word) = arguments.0.first() {
        return Err(format!("unknown argument: {word}\n\n{USAGE}").into());
    }
    if screenshot.is_none() && time.is_none() {
        return window(options);
    }
    let mut headless = Headless::new([width as u32, height as u32], Some(samples))?;
    println!("drawn by {}", headless.adapter());
    options.open(&mut headless.viewer)?;
    // egui measures its panel in the first frame.
    headless.frame(Vec::new())?;
    headless.frame(Vec::new())?;
    if let Some(drag) = drag {
        println!("before the drag: {}", answer(&headless));
        let [x, y, dx, dy] = drag.map(|x| x as f32);
        headless.drag([x, y], [dx, dy])?;
    }
    println!("{}", answer(&headless));
    if let Some(frames) = time {
        times(&mut headless, frames)?;
    }
    if let Some(file) = screenshot {
        headless.save(&file)?;
        println!("{file}");
    }
    Ok(())
}

fn answer(headless: &Headless) -> String {
    headless.viewer.outcome().map_or("no answer".into(), |o| o.to_string())
}

/// Plays the given number of frames and prints the least, median and 95th percentile of their
/// times.
fn times(headless: &mut Headless, frames: usize) -> Result<(), Trouble> {
    if let Source::Recording(player) = &mut headless.viewer.source {
        player.plays = true;
    }
    let mut times: Vec<[f64; 4]> = Vec::with_capacity(frames);
    for _ in 0..frames {
        let start = Instant::now();
        headless.frame(Vec::new())?;
        let [a, b, c] = headless.viewer.times.map(|t| t.as_secs_f64() * 1e3);
        times.push([start.elapsed().as_secs_f64() * 1e3, a, b, c]);
    }
    for (k, name) in ["frame", "stage", "list", "commands"].into_iter().enumerate() {
        times.sort_by(|x, y| x[k].total_cmp(&y[k]));
        let at = |q: f64| times[(frames.saturating_sub(1) as f64 * q) as usize][k];
        println!(
            "{name:>9}: least {:.3} ms, median {:.3} ms, 95 % {:.3} ms",
            at(0.0),
            at(0.5),
            at(0.95)
        );
    }
    Ok(())
}

fn window(options: Options) -> Result<(), Trouble> {
    let native = eframe::NativeOptions {
        viewport: eframe::egui::ViewportBuilder::default().with_inner_size([1100.0, 750.0]),
        ..Default::default()
    };
    let start = move |cc: &eframe::CreationContext<'_>| {
        let state = cc.wgpu_render_state.as_ref().ok_or("no graphics device")?;
        let mut viewer = Viewer::new(&cc.egui_ctx, state, None);
        options.open(&mut viewer).map_err(|e| e.to_string())?;
        Ok(Box::new(viewer) as Box<dyn eframe::App>)
    };
    Ok(eframe::run_native("lin-canny", native, Box::new(start))?)
}
