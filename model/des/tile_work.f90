!> How much work the parcels of each tile are.
module tile_work
  use contact_list, only: contact_list_t
  use kinds, only: wp
  use parcels, only: parcels_t, radius_row
  use tiles, only: tiles_t
  implicit none
  private
  public :: work_of_tiles, kinds_of_work

  !> Ranks wait for each other after each sweep of contacts, and after what is done less often: lists, the choice of close pairs,
  !> coupling.
  integer, parameter :: kinds_of_work = 2, sweep = 1, seldom = 2

  ! In the time that a step takes for a parcel by itself, measured in beds from loose to packed.
  real(wp), parameter :: touch_work = 4.6_wp   !< of the sweep, for a pair that touches
  real(wp), parameter :: wall_work = 8.7_wp    !< of the sweep, for a parcel near walls, beside
  real(wp), parameter :: parcel_work = 1.5_wp  !< of the rest, for a parcel
  real(wp), parameter :: entry_work = 0.2_wp   !< of the rest, for a listed pair

contains

  !> Of my parcels and of the pairs in their rows.
  pure function work_of_tiles(tiles, parcels, list, near_walls) result(work)
    type(tiles_t), intent(in) :: tiles
    type(parcels_t), intent(in) :: parcels
    type(contact_list_t), intent(in) :: list
    integer, intent(in) :: near_walls(:)  !< columns of parcels near walls
    real(wp) :: work(kinds_of_work, tiles%total)

    real(wp) :: own, beside(parcels%n)
    integer :: i, k, t

    work = 0.0_wp
    beside = 0.0_wp
    do k = 1, size(near_walls)  ! where walls meet a parcel is there more than once
      beside(near_walls(k)) = wall_work
    end do
    do i = 1, parcels%n
      own = 1 + beside(i)
      do k = list%first(i), list%first(i + 1) - 1
        associate (a => parcels%state(:, i), b => parcels%state(:, list%partner(k)))
          if (sum((a(1:3) - b(1:3))**2) < (a(radius_row) + b(radius_row))**2) own = own + touch_work
        end associate
      end do
      t = tiles%tile_of(parcels%state(1:3, i))
      work(sweep, t) = work(sweep, t) + own
      work(seldom, t) = work(seldom, t) + parcel_work + entry_work*(list%first(i + 1) - list%first(i))
    end do
  end function work_of_tiles

end module tile_work
