!> geldart CASE.nml [options], as the user wrote it.
module command_line
  use problems, only: problems_t
  use text, only: line_length, string_t, shown, nearest_name, starts_with
  implicit none
  private
  public :: command_line_t, parse_command_line, parse_arguments, print_usage

  type :: command_line_t
    character(len=:), allocatable :: case_file             !< nothing if --help or --version is all that is asked
    character(len=line_length), allocatable :: overrides(:)  !< of --set: 'group%key=value'
    character(len=:), allocatable :: restart               !< file to continue from, or nothing
    character(len=:), allocatable :: out                   !< folder for the results instead of the case's, or nothing
    character(len=:), allocatable :: help_group            !< group whose keys to list, or nothing
    logical :: check = .false.
    logical :: force = .false.
    logical :: help = .false.
    logical :: version = .false.
    logical :: markdown = .false.
  end type command_line_t

contains

  subroutine parse_command_line(command, problems)
    type(command_line_t), intent(out) :: command
    type(problems_t), intent(inout) :: problems

    type(string_t) :: arguments(command_argument_count())
    integer :: i, length

    do i = 1, size(arguments)
      call get_command_argument(i, length=length)
      allocate (character(len=length) :: arguments(i)%text)
      call get_command_argument(i, value=arguments(i)%text)
    end do
    call parse_arguments(arguments, command, problems)
  end subroutine parse_command_line

  subroutine parse_arguments(arguments, command, problems)
    type(string_t), intent(in) :: arguments(:)
    type(command_line_t), intent(out) :: command
    type(problems_t), intent(inout) :: problems

    integer :: i

    command%case_file = ''
    command%restart = ''
    command%out = ''
    command%help_group = ''
    allocate (command%overrides(0))
    i = 1
    do while (i <= size(arguments))
      call take_argument(arguments, i, command, problems)
      i = i + 1
    end do
    if (command%help .or. command%version .or. command%markdown) return
    call problems%require(len(command%case_file) > 0, 'command line: the case file is missing; see --help')
  end subroutine parse_arguments

  !> Take the i-th argument and its value, if it has one.
  subroutine take_argument(arguments, i, command, problems)
    type(string_t), intent(in) :: arguments(:)
    integer, intent(inout) :: i    !< on return, the last argument taken
    type(command_line_t), intent(inout) :: command
    type(problems_t), intent(inout) :: problems

    character(len=:), allocatable :: name, value

    call split_option(arguments(i)%text, name, value)
    select case (name)
    case ('--check', '--force', '--version', '--markdown')
      call problems%require(len(value) == 0, 'command line: '//name//' takes no value')
      command%check = command%check .or. name == '--check'
      command%force = command%force .or. name == '--force'
      command%version = command%version .or. name == '--version'
      command%markdown = command%markdown .or. name == '--markdown'
    case ('--help', '-h')
      command%help = .true.
      command%help_group = value
      if (len(value) == 0) call take_group(arguments, i, command%help_group)
    case ('--set')
      call take_value(arguments, i, name, value, problems)
      call problems%require(len(value) <= line_length, 'command line: --set '//value//': has more than ' &
                            //shown(line_length)//' characters')
      if (len(value) > 0) command%overrides = [character(len=line_length) :: command%overrides, value]
    case ('--restart')
      command%restart = value
      call take_value(arguments, i, name, command%restart, problems)
    case ('--out')
      command%out = value
      call take_value(arguments, i, name, command%out, problems)
    case default
      call take_case_file(arguments(i)%text, command, problems)
    end select
  end subroutine take_argument

  !> '--out=folder' as '--out' and 'folder'.
  pure subroutine split_option(argument, name, value)
    character(len=*), intent(in) :: argument
    character(len=:), allocatable, intent(out) :: name, value

    integer :: equals

    name = argument
    value = ''
    equals = index(argument, '=')
    if (.not. starts_with(argument, '--') .or. equals == 0) return
    name = argument(:equals - 1)
    value = argument(equals + 1:)
  end subroutine split_option

  !> The next argument as the value of an option, unless the option brought one itself.
  subroutine take_value(arguments, i, name, value, problems)
    type(string_t), intent(in) :: arguments(:)
    integer, intent(inout) :: i
    character(len=*), intent(in) :: name
    character(len=:), allocatable, intent(inout) :: value
    type(problems_t), intent(inout) :: problems

    if (len(value) > 0) return
    i = i + 1
    if (i <= size(arguments)) then
      if (.not. starts_with(arguments(i)%text, '--')) value = arguments(i)%text
    end if
    if (len(value) == 0) i = i - 1
    call problems%require(len(value) > 0, 'command line: '//name//' needs a value')
  end subroutine take_value

  !> --help may be followed by the name of a group, with or without its &.
  subroutine take_group(arguments, i, group)
    type(string_t), intent(in) :: arguments(:)
    integer, intent(inout) :: i
    character(len=:), allocatable, intent(inout) :: group

    if (i == size(arguments)) return
    if (starts_with(arguments(i + 1)%text, '--') .or. index(arguments(i + 1)%text, '.') > 0) return
    i = i + 1
    group = arguments(i)%text
    if (starts_with(group, '&')) group = group(2:)
  end subroutine take_group

  subroutine take_case_file(argument, command, problems)
    character(len=*), intent(in) :: argument
    type(command_line_t), intent(inout) :: command
    type(problems_t), intent(inout) :: problems

    character(len=10), parameter :: names(8) = [character(len=10) :: '--check', '--set', '--restart', '--out', &
                                               '--force', '--help', '--version', '--markdown']
    type(string_t) :: options(size(names))
    character(len=:), allocatable :: message
    integer :: i, best

    if (.not. starts_with(argument, '-')) then
      call problems%require(len(command%case_file) == 0, 'command line: '//argument//': there is one case file already, ' &
                            //command%case_file)
      command%case_file = argument
      return
    end if
    do i = 1, size(names)
      options(i)%text = trim(names(i))
    end do
    best = nearest_name(argument, options)
    message = 'command line: '//argument//': there is no such option; '
    if (best > 0) message = message//'did you mean '//options(best)%text//'?'
    if (best == 0) message = message//'see --help'
    call problems%add(message)
  end subroutine take_case_file

  subroutine print_usage(unit)
    integer, intent(in) :: unit

    write (unit, '(a)') &
      'geldart CASE.nml [options]            compute the case; exit code 0: done, 2: a mistake in the case,', &
      '                                      3: the run failed, 4: the machine did, 85: stopped with a restart file', &
      '  --check                             read and check the case, say what it implies, compute nothing', &
      '  --set GROUP%KEY=VALUE               replace what the case file says; any number of times', &
      '  --set ''GROUP(ID)%KEY=VALUE''         the same where a group has several records', &
      '  --restart FILE                      continue from a restart file', &
      '  --out DIR                           folder of the results', &
      '  --force                             replace results that are there', &
      '  --help [GROUP]                      this text and the groups of a case file, or the keys of a group', &
      '  --version                           version and build', &
      '  --markdown                          all groups and keys as doc/inputs.md has them', &
      ''
  end subroutine print_usage

end module command_line
