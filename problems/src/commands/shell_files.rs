//! Files for a shell: `completions SHELL`, from the description behind the help.

use crate::commands::failure::Failure;
use clap::ValueEnum;
use clap_complete::Shell;

/// Examples at the end of the help. `scene`: what names the scene, with a blank, for a binary that takes any.
pub fn examples(binary: &str, scene: &str) -> String {
    let new = match scene {
        "" => String::new(),
        _ => format!("{binary} new part.msh\n      a first scene for a mesh, part.toml\n  "),
    };
    format!(
        "Examples:\n  {new}\
         {binary} {scene}--out results/run\n      \
         optimize; report, pictures and data go to results/run\n  \
         {binary} --resume results/run --max-evaluations 300\n      \
         go on where that run stopped\n  \
         {binary} {scene}evaluate --mesh 24 --controls results/run/controls.json\n      \
         the shape found, on a finer mesh\n  \
         {binary} {scene}--friction 0 --objective peak-pressure\n      \
         another problem\n  \
         {binary} completions bash\n      \
         completions for a shell (bash, elvish, fish, powershell, zsh)"
    )
}

/// The file that the arguments of a program ask for, if they ask for one: `completions SHELL`.
pub fn asked(command: &clap::Command, arguments: &[String]) -> Option<Result<String, Failure>> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["completions", shell] => Some(Shell::from_str(shell, true).map_or_else(unknown, |shell| {
            let (mut command, mut bytes) = (command.clone(), Vec::new());
            let name = command.get_name().to_owned();
            clap_complete::generate(shell, &mut command, name, &mut bytes);
            String::from_utf8(bytes).map_err(Failure::computation)
        })),
        ["completions", ..] => Some(unknown(String::new())),
        _ => None,
    }
}

fn unknown(_: String) -> Result<String, Failure> {
    let names: Vec<String> = Shell::value_variants().iter().map(ToString::to_string).collect();
    Err(Failure::Input(format!("completions needs the name of a shell; allowed: {}", names.join(", "))))
}
