# Completions of gonogo for fish. The program itself says what may stand at the cursor (`gonogo complete -- WORDS`).
function __gonogo_complete
    set -l words (commandline -opc)
    set -l word (commandline -ct)
    set -l program (string replace -r '^~' $HOME -- $words[1])
    set -e words[1]
    for line in ($program complete -- $words $word 2>/dev/null)
        switch $line
            case ':file'
                __fish_complete_path (string replace -r '^--[^=]*=' '' -- $word)
            case ':folder'
                __fish_complete_directories (string replace -r '^--[^=]*=' '' -- $word)
            case ':none'
            case '*'
                echo $line
        end
    end
end
complete -c gonogo -f -a '(__gonogo_complete)'
