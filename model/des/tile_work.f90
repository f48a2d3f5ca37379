!> How much work the parcels of each tile are in a solids step.
module tile_work
  use contact_list, only: contact_list_t
  use kinds, only: wp
  use parcels, only: parcels_t, radius_row
  use tiles, only: tiles_t
  implicit none
  private
  public :: work_of_tiles

  ! Over that of a parcel by itself, coupling and lists included; fitted to the steps of two ranks of a bubbling bed.
  real(wp), parameter :: entry_work = 0.2_wp  !< of a listed pair
  real(wp), parameter :: touch_work = 1.5_wp  !< of one that touches, beside
  real(wp), parameter :: wall_work = 2.5_wp   !< of a parcel near walls, beside

contains

  !> Of my parcels and of the pairs in their rows, over that of a parcel by itself.
  pure function work_of_tiles(tiles, parcels, list, near_walls) result(work)
    type(tiles_t), intent(in) :: tiles
    type(parcels_t), intent(in) :: parcels
    type(contact_list_t), intent(in) :: list
    integer, intent(in) :: near_walls(:)  !< columns of parcels near walls
    real(wp) :: work(tiles%total)

    real(wp) :: own, beside(parcels%n)
    integer :: i, k, t

    work = 0.0_wp
    beside = 0.0_wp
    do k = 1, size(near_walls)  ! where walls meet a parcel is there more than once
      beside(near_walls(k)) = wall_work
    end do
    do i = 1, parcels%n
      own = 1 + beside(i) + entry_work*(list%first(i + 1) - list%first(i))
      do k = list%first(i), list%first(i + 1) - 1
        associate (a => parcels%state(:, i), b => parcels%state(:, list%partner(k)))
          if (sum((a(1:3) - b(1:3))**2) < (a(radius_row) + b(radius_row))**2) own = own + touch_work
        end associate
      end do
      t = tiles%tile_of(parcels%state(1:3, i))
      work(t) = work(t) + own
    end do
  end function work_of_tiles

end module tile_work
