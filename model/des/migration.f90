!> Parcels move house: each goes to the rank that owns its place, with everything known of it and the slips of
!> its contacts.
module migration
  use chamber, only: chamber_t
  use communicator, only: communicator_t
  use contact_history, only: history_t
  use kinds, only: wp, i8
  use parcels, only: parcels_t, mass_row
  use route, only: route_t
  use tiles, only: tiles_t
  implicit none
  private
  public :: settle_owners

  integer, parameter :: nowhere = -1  !< destination of a parcel that has left through an open face

contains

  !> Every parcel to the rank that owns its place; those beyond an open face leave the run. All ranks take part.
  subroutine settle_owners(comm, tiles, chamber, parcels, history, gone, mass)
    type(communicator_t), intent(in) :: comm
    type(tiles_t), intent(in) :: tiles
    type(chamber_t), intent(in) :: chamber
    type(parcels_t), intent(inout) :: parcels
    type(history_t), intent(inout) :: history
    integer(i8), intent(out) :: gone   !< parcels that have left, on all ranks
    real(wp), intent(out) :: mass      !< of these [kg]

    integer :: destination(parcels%n), i

    gone = 0
    mass = 0.0_wp
    do i = 1, parcels%n
      associate (x => parcels%state(1:3, i))
        call tiles%wrap(x)
        destination(i) = tiles%owner_of(x)
        if (.not. any((chamber%open(1, :) .and. x < chamber%lower) .or. (chamber%open(2, :) .and. x > chamber%upper))) cycle
      end associate
      destination(i) = nowhere
      gone = gone + 1
      mass = mass + 1/parcels%state(mass_row, i)
    end do
    if (comm%size > 1 .or. gone > 0) call migrate(comm, destination, parcels, history)
    if (.not. any(chamber%open)) return
    gone = comm%sum(gone)
    mass = comm%sum(mass)
  end subroutine settle_owners

  !> Send parcel i to the rank destination(i). All ranks take part. The last of those that stay fill the gaps; who comes is
  !> appended.
  subroutine migrate(comm, destination, parcels, history)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: destination(:)  !< (n) rank, or nowhere
    type(parcels_t), intent(inout) :: parcels
    type(history_t), intent(inout) :: history

    type(history_t) :: leaving
    integer, allocatable :: leaves(:)
    integer :: column(parcels%n), place(parcels%n), stay, i

    column = [(i, i=1, parcels%n)]
    stay = count(destination == comm%rank)
    leaves = pack(column, destination /= comm%rank .and. destination /= nowhere)
    place = merge(column, 0, destination == comm%rank)
    place(pack(column(stay + 1:), destination(stay + 1:) == comm%rank)) = pack(column(:stay), destination(:stay) /= comm%rank)
    place(leaves) = -[(i, i=1, size(leaves))]
    call part_records(parcels, place, history, leaving)
    call swap_parcels(comm, destination(leaves), leaves, place, parcels, history, leaving)
  end subroutine migrate

  !> Split the records between those whose parcel stays, which follow it to its new column, and those that
  !> leave with it. place(i) is the new column of i, minus its number among those that leave, or 0.
  subroutine part_records(parcels, place, history, leaving)
    type(parcels_t), intent(in) :: parcels
    integer, intent(in) :: place(:)
    type(history_t), intent(inout) :: history
    type(history_t), intent(inout) :: leaving  !< `own` counts the parcels that leave

    integer :: m, i, j

    leaving%rows = history%rows
    call leaving%clear()
    do m = history%n, 1, -1
      i = history%own(m)
      j = history%other(m)
      if (j == 0) then
        if (place(i) < 0) call leaving%append(-place(i), 0, history%other_id(m), history%slip(:, m))
        history%own(m) = place(i)
      else if (place(i) > 0 .and. place(j) > 0) then
        history%own(m) = place(i)
        history%other(m) = place(j)
      else
        if (place(i) < 0) call leaving%append(-place(i), 0, parcels%id(j), history%slip(:, m))
        if (place(j) < 0) call leaving%append(-place(j), 0, parcels%id(i), -history%slip(:, m))
        if (place(j) > 0) then
          call history%put(m, place(j), 0, parcels%id(i), -history%slip(:, m))
        else
          call history%put(m, place(i), 0, parcels%id(j), (history%slip(:, m)))
        end if
      end if
      if (history%own(m) <= 0) call history%drop(m)
    end do
  end subroutine part_records

  !> The messages: parcels, then their records in the order of the parcels.
  subroutine swap_parcels(comm, destination, leaves, place, parcels, history, leaving)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: destination(:)  !< (size(leaves)) rank
    integer, intent(in) :: leaves(:)       !< their columns
    integer, intent(in) :: place(:)        !< new columns of those that stay
    type(parcels_t), intent(inout) :: parcels
    type(history_t), intent(inout) :: history
    type(history_t), intent(in) :: leaving

    type(route_t) :: route
    real(wp), allocatable :: reals(:,:), reals_in(:,:)
    integer(i8), allocatable :: longs(:,:), longs_in(:,:)
    integer :: m, n

    call route%set(comm, destination)
    allocate (reals(parcels%packed_rows(), route%n_sent), reals_in(parcels%packed_rows(), route%n_received))
    allocate (longs(3, route%n_sent), longs_in(3, route%n_received))
    call parcels%pack_rows(leaves, reals, longs(1:2, :))
    longs(3, :) = 0_i8
    do m = 1, leaving%n
      longs(3, leaving%own(m)) = longs(3, leaving%own(m)) + 1
    end do
    call route%send(reals, reals_in)
    call route%send(longs, longs_in)
    call parcels%move(place)
    n = parcels%n
    call parcels%unpack_rows(reals_in, longs_in(1:2, :))
    if (parcels%rotation) call swap_records(comm, destination, leaving, n, int(longs_in(3, :)), history)
  end subroutine swap_parcels

  subroutine swap_records(comm, destination, leaving, n, counts, history)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: destination(:)  !< of the parcels that leave
    type(history_t), intent(in) :: leaving
    integer, intent(in) :: n               !< column before the first newcomer
    integer, intent(in) :: counts(:)       !< records of each newcomer
    type(history_t), intent(inout) :: history

    type(route_t) :: route
    real(wp), allocatable :: slip_in(:,:)
    integer(i8), allocatable :: id_in(:,:)
    integer :: order(leaving%n), m, c, r

    order = by_owner(leaving%own(1:leaving%n), size(destination))
    call route%set(comm, destination(leaving%own(order)))
    allocate (slip_in(history%rows, route%n_received), id_in(1, route%n_received))
    call route%send(leaving%slip(:, order), slip_in)
    call route%send(reshape(leaving%other_id(order), [1, leaving%n]), id_in)
    r = 0
    do c = 1, size(counts)
      do m = 1, counts(c)
        r = r + 1
        call history%append(n + c, 0, id_in(1, r), slip_in(:, r))
      end do
    end do
  end subroutine swap_records

  !> The order that sorts records by their owner, 1 to `owners`; equals keep their order.
  pure function by_owner(own, owners) result(order)
    integer, intent(in) :: own(:), owners
    integer :: order(size(own))

    integer :: next(owners + 1), m, c

    next = 0
    do m = 1, size(own)
      next(own(m) + 1) = next(own(m) + 1) + 1
    end do
    next(1) = 1
    do c = 2, owners + 1
      next(c) = next(c) + next(c - 1)
    end do
    do m = 1, size(own)
      order(next(own(m))) = m
      next(own(m)) = next(own(m)) + 1
    end do
  end function by_owner

end module migration
