!> Work of the solids steps, evened out between the ranks.
module load_balance
  use contact_list, only: contact_list_t
  use kinds, only: wp, i8
  use parcels, only: parcels_t
  use tile_work, only: work_of_tiles, kinds_of_work
  use tiles, only: tiles_t
  implicit none
  private
  public :: rebalance, lists_per_look

  real(wp), parameter :: noticed_imbalance = 1.01_wp  !< time over that of even work, above which tiles change hands
  integer(i8), parameter :: lists_per_look = 4          !< lists made from one look to the next, which is no small work

contains

  !> Let tiles change hands if the work, parcels and their contacts, is too unevenly spread; new lists take the parcels to
  !> their new owners. All ranks take part.
  subroutine rebalance(tiles, parcels, list, near_walls, changed)
    type(tiles_t), intent(inout) :: tiles
    type(parcels_t), intent(in) :: parcels
    type(contact_list_t), intent(in) :: list
    integer, intent(in) :: near_walls(:)  !< columns of parcels near walls
    logical, intent(out) :: changed       !< whether any tile has another owner now

    real(wp) :: work(kinds_of_work, tiles%total)

    changed = .false.
    work = work_of_tiles(tiles, parcels, list, near_walls)
    if (tiles%imbalance(work) > noticed_imbalance) call tiles%repartition(work, changed)
  end subroutine rebalance

end module load_balance
