!> What ends a run of parcels: one that is nowhere, one that has gone through a wall, a chamber that bites its tail.
module solids_trouble
  use communicator, only: communicator_t
  use kinds, only: wp
  use outcome, only: outcome_t, exit_failed, exit_input
  use parcels, only: parcels_t
  use chamber, only: chamber_t, n_faces
  implicit none
  private
  public :: find_trouble, check_period, least_period

  real(wp), parameter :: least_period = 3.0_wp  !< in ranges: a pair touches itself or one image, never both

contains

  !> Fail if a parcel of any rank has no position or velocity or is beyond a wall. All ranks take part.
  subroutine find_trouble(comm, chamber, parcels, time, outcome)
    type(communicator_t), intent(in) :: comm
    type(chamber_t), intent(in) :: chamber
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: time  !< [s]
    type(outcome_t), intent(inout) :: outcome

    real(wp) :: facts(5)
    integer :: i, teller

    i = first_astray(chamber, parcels)
    teller = comm%max(merge(comm%rank, -1, i > 0))
    if (teller < 0) return
    facts = 0.0_wp
    if (teller == comm%rank) facts = [real(parcels%id(i), wp), parcels%state(1:3, i), norm2(parcels%state(5:7, i))]
    facts = comm%sum(facts)
    call outcome%fail(exit_failed, report(facts, time))
  end subroutine find_trouble

  !> The first parcel that is not a number or beyond a wall, 0 if there is none.
  pure function first_astray(chamber, parcels) result(i)
    type(chamber_t), intent(in) :: chamber
    type(parcels_t), intent(in) :: parcels
    integer :: i

    logical :: closed(2, 3)
    integer :: face

    closed = reshape([(chamber%is_wall(face), face=1, n_faces)], [2, 3])
    do i = 1, parcels%n
      associate (s => parcels%state(1:7, i))
        if (.not. all(abs(s) <= huge(1.0_wp))) return
        if (any((closed(1, :) .and. s(1:3) < chamber%lower) .or. (closed(2, :) .and. s(1:3) > chamber%upper))) return
        if (chamber%is_beyond(s(1:3), s(4))) return
      end associate
    end do
    i = 0
  end function first_astray

  pure function report(facts, time) result(message)
    real(wp), intent(in) :: facts(5)  !< id, position [m], speed [m/s]
    real(wp), intent(in) :: time      !< [s]
    character(len=:), allocatable :: message

    character(len=400) :: text

    write (text, '(a,i0,3(a,g0.5),a,g0.5,a,g0.5,3a)') 'parcel ', nint(facts(1)), ' at (', facts(2), ', ', facts(3), &
      ', ', facts(4), ') m, speed ', facts(5), ' m/s, time ', time, ' s, ', &
      'has gone through a wall or lost its place: ', &
      'contacts are too soft or steps too long; raise &contact stiffness or &numerics steps_per_collision'
    message = trim(text)
  end function report

  !> Fail if a periodic direction is too short for a pair to meet in one way only.
  subroutine check_period(chamber, range, outcome)
    type(chamber_t), intent(in) :: chamber
    real(wp), intent(in) :: range  !< of contacts [m]
    type(outcome_t), intent(inout) :: outcome

    character(len=300) :: text
    integer :: a

    do a = 1, 3
      if (.not. chamber%periodic(a)) cycle
      if (chamber%upper(a) - chamber%lower(a) >= least_period*range) cycle
      write (text, '(3a,g0.4,a,g0.4,a)') 'the periodic direction ', 'xyz'(a:a), ' is ', &
        chamber%upper(a) - chamber%lower(a), ' m long; parcels of this size need ', &
        least_period*range, ' m: lengthen &domain or take smaller parcels'
      call outcome%fail(exit_input, trim(text))
    end do
  end subroutine check_period

end module solids_trouble
