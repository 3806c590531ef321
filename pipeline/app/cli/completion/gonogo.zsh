#compdef gonogo
# Completions of gonogo for zsh. The program itself says what may stand at the cursor (`gonogo complete -- WORDS`).
_gonogo() {
  local program=${(Q)words[1]} line files=:none
  local -a candidates
  [[ $program == \~* ]] && program=${~program}
  for line in "${(@f)$("$program" complete -- "${(@Q)words[2,CURRENT]}" 2>/dev/null)}"; do
    if [[ $line == :* ]]; then
      files=$line
    elif [[ $line == *$'\t'* ]]; then
      candidates+=("${${line%%$'\t'*}//:/\\:}:${line#*$'\t'}")
    elif [[ -n $line ]]; then
      candidates+=("${line//:/\\:}")
    fi
  done
  local -a no_blank
  [[ $candidates[1] == *=(|:*) ]] && no_blank=(-S '')
  (( $#candidates )) && _describe -t values 'gonogo' candidates "$no_blank[@]"
  [[ $files != :none && $PREFIX == --*=* ]] && compset -P '*='
  case $files in
    :file) _files ;;
    :folder) _files -/ ;;
  esac
}
if [[ $zsh_eval_context[-1] == loadautofunc ]]; then
  _gonogo "$@"
else
  compdef _gonogo gonogo
fi
