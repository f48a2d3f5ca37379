!> A signal, a stop file and the wall clock each ask a run to stop, and all ranks hear of it; then the exit code.
program test_stopping
  use, intrinsic :: iso_c_binding, only: c_int
  use check, only: expect, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: unset
  use files, only: make_folder, exists
  use kinds, only: wp
  use outcome, only: outcome_t
  use signals, only: catch_signals, caught_signal, quit
  use stop_request, only: stop_request_t
  use timing, only: wall_seconds
  implicit none

  interface
    function c_raise(number) result(status) bind(C, name='raise')
      import :: c_int
      implicit none
      integer(c_int), value :: number
      integer(c_int) :: status
    end function c_raise
  end interface

  type(communicator_t) :: comm
  type(outcome_t) :: outcome
  character(len=:), allocatable :: folder
  logical :: at_first, by_clock, by_file, file_gone, by_signal
  character(len=80) :: reasons(3)
  integer(c_int) :: status

  call start_ranks(comm)
  call catch_signals()
  folder = 'build/tests/stopping_'//achar(iachar('0') + comm%size)
  if (comm%is_root()) call make_folder(folder, outcome)
  call try(unset, at_first, reasons(1), 0.0_wp)
  call try(0.05_wp, by_clock, reasons(1), 0.2_wp)
  call try(unset, by_file, reasons(2), 0.6_wp, with_file=.true.)
  file_gone = .not. exists(folder//'/stop')
  status = 0
  if (comm%rank == comm%size - 1) status = c_raise(12_c_int)   ! USR2, on one rank only
  call try(unset, by_signal, reasons(3), 0.0_wp)
  if (comm%is_root()) then
    call expect(status == 0, 'a signal does not end the program')
    call expect(.not. at_first, 'nothing stops a run by itself')
    call expect(by_clock .and. reasons(1) == 'the wall clock limit', 'the wall clock stops it')
    call expect(by_file .and. reasons(2) == "the file '"//folder//"/stop'", 'a stop file stops it')
    call expect(file_gone, 'and is used up')
    call expect(by_signal .and. reasons(3) == 'signal USR2', 'a signal on any rank stops all')
    call finish()
  end if
  call stop_ranks()
  call quit(0)

contains

  !> Wait, perhaps with a stop file made meanwhile, and ask.
  subroutine try(limit, made, reason, seconds, with_file)
    real(wp), intent(in) :: limit, seconds
    logical, intent(out) :: made
    character(len=80), intent(out) :: reason
    logical, intent(in), optional :: with_file

    type(stop_request_t) :: request
    real(wp) :: from
    integer :: unit

    call request%start(comm, folder, limit)
    if (present(with_file) .and. comm%is_root()) then
      open (newunit=unit, file=folder//'/stop', action='write')
      close (unit)
    end if
    from = wall_seconds()
    do while (wall_seconds() - from < seconds)
    end do
    made = request%is_made(comm)
    reason = request%reason()
  end subroutine try

end program test_stopping
