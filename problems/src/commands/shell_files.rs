//! Files for a shell and for `man`: `completions SHELL` and `man`, from the description behind the help.

use crate::commands::failure::Failure;
use clap::ValueEnum;
use clap_complete::Shell;
use clap_mangen::Man;

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
         completions for a shell (bash, elvish, fish, powershell, zsh)\n  \
         {binary} man\n      \
         this page for man: {binary} man > {binary}.1; man ./{binary}.1"
    )
}

/// The file that the arguments of a program ask for, if they ask for one: `completions SHELL` or `man`.
pub fn asked(command: &clap::Command, arguments: &[String]) -> Option<Result<String, Failure>> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["completions", shell] => Some(Shell::from_str(shell, true).map_or_else(unknown, |shell| {
            let (mut command, mut bytes) = (command.clone(), Vec::new());
            let name = command.get_name().to_owned();
            clap_complete::generate(shell, &mut command, name, &mut bytes);
            text(bytes)
        })),
        ["completions", ..] => Some(unknown(String::new())),
        ["man"] => Some(manual(command)),
        _ => None,
    }
}

/// The page for `man`: the program, and for every command what `optimize` does not take.
fn manual(command: &clap::Command) -> Result<String, Failure> {
    let mut bytes = Vec::new();
    Man::new(command.clone()).render(&mut bytes).map_err(Failure::computation)?;
    for part in command.get_subcommands() {
        let known = |id: &clap::Id| command.get_arguments().any(|argument| argument.get_id() == id);
        if part.get_arguments().all(|argument| known(argument.get_id())) {
            continue;
        }
        let mut section = Vec::new();
        let own = part.clone().disable_help_flag(true).mut_args(|argument| {
            let is_known = known(argument.get_id());
            argument.hide(is_known)
        });
        Man::new(own).render_options_section(&mut section).map_err(Failure::computation)?;
        let heading = format!(".SH \"OPTIONS OF {}\"\n", part.get_name().to_uppercase());
        bytes.extend((heading + &text(section)?.replace(".SH ", ".SS ")).into_bytes());
    }
    text(bytes)
}

fn unknown(_: String) -> Result<String, Failure> {
    let names: Vec<String> = Shell::value_variants().iter().map(ToString::to_string).collect();
    Err(Failure::Input(format!("completions needs the name of a shell; allowed: {}", names.join(", "))))
}

fn text(bytes: Vec<u8>) -> Result<String, Failure> {
    String::from_utf8(bytes).map_err(Failure::computation)
}
