!> Everything a restart needs to go on as if nothing had happened, as plain arrays.
!>
!> Every rank gives its own part, parcels in their present order. Read back by the same ranks, each its own part,
!> the run goes on bit for bit: the lists are made again at the places where they were made before, from parcels
!> in the order they had, so they are the same lists. Read back by another number of ranks, in any portions that
!> keep a parcel with its contacts, parcels find their way and the run goes on to rounding.
module solids_state
  use contact_history, only: history_t
  use contact_parts, only: gathered
  use kinds, only: wp, i8
  use outcome, only: outcome_t
  use parcels, only: parcels_t, coupled_rows, radius_row, mass_row, curvature_row
  use solids, only: solids_t
  implicit none
  private
  public :: solids_state_t, export_state, import_state, n_scalars, n_counts, parcel_rows

  integer, parameter :: n_scalars = 11, n_counts = 4
  integer, parameter :: plain_rows = 22

  type :: solids_state_t
    ! Of the whole run, the same on all ranks.
    !> time [s], step, travelled [m], mass added, mass left [kg], largest and smallest radius [m], smallest mass of
    !> a parcel [kg], listed at [s], largest radius over mass [m/kg], skin [m]: the components of solids of these names
    real(wp) :: scalars(n_scalars) = 0.0_wp
    integer(i8) :: counts(n_counts) = 0_i8      !< parcels added, parcels left, lists made, lists weighed
    integer, allocatable :: owner(:)            !< rank of each tile
    real(wp), allocatable :: least(:,:)         !< (2,materials) with several: smallest mass [kg] and radius [m] of a parcel
    ! Of this rank.
    !> (22 or 34, n) 1:3 position, 4:6 position when the lists were made [m], 7:9 velocity, 10:12 angular velocity
    !> times radius [m/s], 13 collision radius [m], 14 inverse mass [1/kg], 15 diameter [m], 16 weight, 17:22
    !> lead of velocity and spin, see motion [m/s]; with gas 23:34 the rows of `coupled`, see parcels
    real(wp), allocatable :: parcels(:,:)
    integer(i8), allocatable :: labels(:,:)     !< (3,n) id, powder, number of contacts
    integer(i8), allocatable :: partner(:)      !< (contacts) id, or -face of a wall; parcel after parcel
    real(wp), allocatable :: slip(:,:)          !< (3 or 6,contacts) from the parcel to the partner, see contact_history
  end type solids_state_t

contains

  !> Rows of `parcels` in a state.
  pure function parcel_rows(with_gas)
    logical, intent(in) :: with_gas
    integer :: parcel_rows

    parcel_rows = plain_rows + merge(coupled_rows, 0, with_gas)
  end function parcel_rows

  !> The state of this rank as it is now.
  subroutine export_state(solids, state)
    type(solids_t), intent(in) :: solids
    type(solids_state_t), intent(out) :: state

    integer :: i

    associate (p => solids%parcels)
      allocate (state%parcels(parcel_rows(p%with_gas), p%n), state%labels(3, p%n))
      do i = 1, p%n
        associate (row => state%parcels(:, i), s => p%state(:, i))
          row(1:16) = [s(1:3), p%built(:, i), s(5:7), 0.0_wp, 0.0_wp, 0.0_wp, s(radius_row), s(mass_row), &
                       p%diameter(i), p%weight(i)]
          if (p%rotation) row(10:12) = s(9:11)
          row(17:22) = [p%aside(1:3, i), 0.0_wp, 0.0_wp, 0.0_wp]
          if (p%rotation) row(20:22) = p%aside(5:7, i)
          if (p%with_gas) row(plain_rows + 1:) = p%coupled(:, i)
        end associate
        state%labels(:, i) = [p%id(i), int(p%powder(i), i8), 0_i8]
      end do
    end associate
    allocate (state%owner(0))
    if (allocated(solids%tiles%owner)) state%owner = solids%tiles%owner
    state%scalars = [solids%time, solids%step, solids%travelled, solids%mass_added, solids%mass_left, &
                     solids%largest_radius, solids%smallest_radius, minval(solids%lightest), solids%listed_at, &
                     solids%largest_ratio, solids%skin]
    if (size(solids%lightest) > 1) then
      allocate (state%least(2, size(solids%lightest)))
      state%least(1, :) = solids%lightest
      state%least(2, :) = solids%smallest
    end if
    state%counts = [solids%added, solids%left, solids%rebuilds, solids%weighed]
    call export_contacts(solids, state)
  end subroutine export_state

  !> The slips, each contact with both its parcels.
  subroutine export_contacts(solids, state)
    type(solids_t), intent(in) :: solids
    type(solids_state_t), intent(inout) :: state

    type(history_t) :: history
    integer :: next(solids%parcels%n), m, i, j

    history%rows = solids%history%rows
    call history%clear()
    if (solids%parcels%rotation .and. solids%rebuilds > 0) then
      if (allocated(solids%parts)) then
        call history%collect(gathered(solids%parts), solids%walls, solids%parcels, solids%step)
      else
        call history%collect(solids%pairs, solids%walls, solids%parcels, solids%step)
      end if
    end if
    do m = 1, history%n
      i = history%own(m)
      j = history%other(m)
      state%labels(3, i) = state%labels(3, i) + 1
      if (j > 0) state%labels(3, j) = state%labels(3, j) + 1
    end do
    allocate (state%partner(sum(state%labels(3, :))), state%slip(history%rows, sum(state%labels(3, :))))
    m = 1
    do i = 1, size(next)
      next(i) = m
      m = m + int(state%labels(3, i))
    end do
    do m = 1, history%n
      i = history%own(m)
      j = history%other(m)
      if (j == 0) then
        call put(i, history%other_id(m), history%slip(:, m))
      else
        call put(i, state%labels(1, j), history%slip(:, m))
        call put(j, state%labels(1, i), -history%slip(:, m))
      end if
    end do

  contains

    subroutine put(own, other_id, slip)
      integer, intent(in) :: own
      integer(i8), intent(in) :: other_id
      real(wp), intent(in) :: slip(:)

      state%partner(next(own)) = other_id
      state%slip(:, next(own)) = slip
      next(own) = next(own) + 1
    end subroutine put
  end subroutine export_contacts

  !> Go on from a state. The solids have been created and are empty. All ranks take part.
  subroutine import_state(solids, state, outcome)
    type(solids_t), intent(inout) :: solids
    type(solids_state_t), intent(in) :: state
    type(outcome_t), intent(inout) :: outcome

    real(wp) :: now(3)
    integer :: i

    solids%time = state%scalars(1)
    solids%step = state%scalars(2)
    solids%mass_added = state%scalars(4)
    solids%mass_left = state%scalars(5)
    solids%largest_radius = state%scalars(6)
    solids%smallest_radius = state%scalars(7)
    solids%smallest(:) = state%scalars(7)
    solids%lightest(:) = state%scalars(8)
    if (allocated(state%least)) then
      if (size(state%least, 2) == size(solids%lightest)) then  ! else the case has been given other materials
        solids%lightest(:) = state%least(1, :)
        solids%smallest(:) = state%least(2, :)
      end if
    end if
    solids%listed_at = state%scalars(9)
    solids%largest_ratio = state%scalars(10)
    solids%skin = state%scalars(11)
    solids%added = state%counts(1)
    solids%left = state%counts(2)
    call import_parcels(state, solids%parcels)
    call import_contacts(state, solids%history)
    if (solids%added == 0) return
    call solids%set_reach()
    if (size(state%owner) == solids%tiles%total .and. all(state%owner < solids%comm%size)) then
      call solids%tiles%set_owners(state%owner)
    end if
    if (solids%chamber%fastest > 0.0_wp) call solids%chamber%move_to(solids%listed_at)
    call solids%make_lists(outcome)
    if (solids%chamber%fastest > 0.0_wp) call solids%chamber%move_to(solids%time)
    do i = 1, solids%parcels%n
      now = solids%parcels%built(:, i)
      solids%parcels%built(:, i) = solids%parcels%state(1:3, i)
      solids%parcels%state(1:3, i) = now
    end do
    call solids%ghosts%refresh(solids%parcels, watched=.false.)
    solids%travelled = state%scalars(3)
    solids%rebuilds = state%counts(3)
    solids%weighed = state%counts(4)
  end subroutine import_state

  !> Parcels where the lists were made; `built` keeps where they are now for the moment.
  subroutine import_parcels(state, parcels)
    type(solids_state_t), intent(in) :: state
    type(parcels_t), intent(inout) :: parcels

    integer :: i

    call parcels%reserve(size(state%labels, 2))
    parcels%n = size(state%labels, 2)
    do i = 1, parcels%n
      associate (row => state%parcels(:, i), s => parcels%state(:, i))
        s = 0.0_wp
        s(1:3) = row(4:6)
        s(radius_row) = row(13)
        s(5:7) = row(7:9)
        s(mass_row) = row(14)
        if (parcels%rotation) s(9:curvature_row) = [row(10:12), 1/row(13)]
        parcels%built(:, i) = row(1:3)
        parcels%diameter(i) = row(15)
        parcels%weight(i) = row(16)
        parcels%aside(:, i) = 0.0_wp
        parcels%aside(1:3, i) = row(17:19)
        if (parcels%rotation) parcels%aside(5:7, i) = row(20:22)
        if (parcels%with_gas) parcels%coupled(:, i) = row(plain_rows + 1:)
      end associate
      parcels%id(i) = state%labels(1, i)
      parcels%powder(i) = int(state%labels(2, i))
    end do
  end subroutine import_parcels

  subroutine import_contacts(state, history)
    type(solids_state_t), intent(in) :: state
    type(history_t), intent(inout) :: history

    integer :: i, k, m

    call history%clear()
    m = 0
    do i = 1, size(state%labels, 2)
      do k = 1, int(state%labels(3, i))
        m = m + 1
        call history%append(i, 0, state%partner(m), state%slip(:, m))
      end do
    end do
  end subroutine import_contacts

end module solids_state
