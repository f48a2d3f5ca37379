!> Work of the solids steps, evened out between the ranks.
module load_balance
  use kinds, only: wp, i8
  use outcome, only: outcome_t
  use solids, only: solids_t
  use tile_work, only: work_of_tiles
  implicit none
  private
  public :: rebalance

  real(wp), parameter :: tolerated_imbalance = 1.05_wp  !< largest load over the mean before tiles change hands
  integer(i8), parameter :: lists_per_look = 4          !< lists made from one look to the next, which is no small work

contains

  !> Deal the tiles out anew if the work, parcels and their contacts, is too unevenly spread. The balance is looked at now and then,
  !> when lists have been made. All ranks take part.
  subroutine rebalance(solids, outcome)
    type(solids_t), intent(inout) :: solids
    type(outcome_t), intent(inout) :: outcome

    real(wp) :: work(solids%tiles%total)
    logical :: changed

    if (solids%comm%size == 1 .or. solids%rebuilds < solids%weighed + lists_per_look) return
    solids%weighed = solids%rebuilds
    work = work_of_tiles(solids%tiles, solids%parcels, solids%list, solids%walls%parcel(1:solids%walls%entries))
    if (solids%tiles%imbalance(work) <= tolerated_imbalance) return
    call solids%tiles%repartition(work, changed)
    if (.not. changed) return
    solids%tilings = solids%tilings + 1
    call solids%renew_lists(outcome)
  end subroutine rebalance

end module load_balance
