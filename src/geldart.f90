!> Polydisperse gas-solid beds by coarse-grained CFD-DEM: geldart CASE.nml.
program geldart
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use case, only: case_t
  use case_description, only: describe_case
  use case_reading, only: read_case, print_help, write_inputs_markdown
  use command_line, only: command_line_t, parse_command_line, print_usage
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use hdf5_file, only: start_hdf5, stop_hdf5
  use outcome, only: outcome_t, exit_done, exit_input
  use problems, only: problems_t
  use signals, only: quit
  use simulation, only: simulation_t, orders_t
  use version, only: program_version, git_commit, build_mode
  implicit none

  type(communicator_t) :: comm
  type(command_line_t) :: command
  type(problems_t) :: problems
  type(case_t) :: case
  integer :: code

  call start_ranks(comm)
  code = exit_done
  call parse_command_line(command, problems)
  if (problems%count() == 0) then
    if (command%help .or. command%version .or. command%markdown) then
      if (comm%is_root()) call inform()
    else
      call read_case(command%case_file, command%overrides, case, problems, comm)
      if (problems%count() == 0) call compute()
    end if
  end if
  if (problems%count() > 0) then
    code = exit_input
    if (comm%is_root()) call problems%print(error_unit)
  end if
  call stop_ranks()
  call quit(code)

contains

  !> What can be told without a case.
  subroutine inform()
    if (command%version) print '(7a)', 'geldart ', program_version, ', commit ', git_commit, ', ', build_mode, ' build'
    if (command%markdown) call write_inputs_markdown(output_unit)
    if (command%help .and. len(command%help_group) == 0) call print_usage(output_unit)
    if (command%help) call print_help(command%help_group, output_unit)
  end subroutine inform

  !> Check the case or run it.
  subroutine compute()
    type(simulation_t), allocatable :: simulation
    type(outcome_t) :: outcome
    type(orders_t) :: orders

    if (command%check) then
      if (comm%is_root()) call describe_case(case, output_unit)
      return
    end if
    orders%folder = trim(case%output%folder)
    orders%restart = command%restart
    orders%force = command%force
    if (len(command%out) > 0) orders%folder = command%out
    call start_hdf5()
    allocate (simulation)
    call simulation%set_up(comm, case, orders, outcome)
    if (.not. outcome%failed()) call simulation%run(outcome)
    call simulation%finish(outcome)
    call stop_hdf5()
    code = outcome%code
    if (outcome%failed() .and. comm%is_root()) write (error_unit, '(2a)') 'geldart: ', outcome%message
  end subroutine compute

end program geldart
